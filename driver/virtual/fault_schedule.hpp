// FaultSchedule: what a virtual lidar suffers at which time of its life.
#pragma once

#include "driver/protocol/result.hpp"
#include "driver/virtual/fault_command.hpp"

#include <chrono>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace sweepcast::virtual_lidar {

class FaultSchedule {
public:
    /// Adds what `text` says: "3s unplug, 5s replug, 8.5s fault noise=0.02, 1m clear": a time from
    /// the start (ms, s or m; up to a day) and a command (see parse_fault_command()), and more of
    /// them after commas. Their order does not matter; of the same time the first goes first.
    /// Nothing is added if there is an error: errc::invalid_option.
    [[nodiscard]] Result<void, Problem> add(std::string_view text);

    [[nodiscard]] bool is_empty() const { return entries_.empty(); }

    /// When the next command is due, from the start; none if there is no more.
    [[nodiscard]] std::optional<std::chrono::milliseconds> next_due() const;

    /// Takes the next command if it is due so long after the start.
    std::optional<FaultCommand> take_due(std::chrono::nanoseconds since_start);

private:
    struct Entry {
        std::chrono::milliseconds at{};
        FaultCommand command;
    };
    static Result<Entry, Problem> parse_entry(std::string_view text);

    std::vector<Entry> entries_;  // by time
    std::size_t taken_{};
};

}  // namespace sweepcast::virtual_lidar
