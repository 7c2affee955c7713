#include "driver/virtual/fault_schedule.hpp"

#include "driver/virtual/error.hpp"
#include "driver/virtual/trimmed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <string>
#include <system_error>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace {

using std::chrono::milliseconds;

// "2.5s": seconds; also "ms" and "m". None if it is anything else, negative, or beyond a day.
std::optional<milliseconds> parse_time(std::string_view text) {
    constexpr double most_ms = 24.0 * 3600.0 * 1000.0;
    double number{};
    const auto* const end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data(), end, number);
    if (failure != std::errc{}) {
        return std::nullopt;
    }
    const std::string_view unit(stop, static_cast<std::size_t>(end - stop));
    double unit_ms = 0.0;
    if (unit == "ms") {
        unit_ms = 1.0;
    } else if (unit == "s") {
        unit_ms = 1000.0;
    } else if (unit == "m") {
        unit_ms = 60'000.0;
    } else {
        return std::nullopt;
    }
    const auto time_ms = number * unit_ms;
    // Written so that NaN is refused.
    if (!(time_ms >= 0.0 && time_ms <= most_ms)) {
        return std::nullopt;
    }
    return std::chrono::round<milliseconds>(std::chrono::duration<double, std::milli>(time_ms));
}

}  // namespace

Result<FaultSchedule::Entry, Problem> FaultSchedule::parse_entry(std::string_view text) {
    const auto end = std::min(text.find_first_of(" \t\n"), text.size());
    const auto at = parse_time(text.substr(0, end));
    if (!at) {
        return Problem{
            errc::invalid_option,
            fmt::format("\"{}\" in the schedule does not begin with a time", text),
            "write times from the start and commands, e.g. 3s unplug, 5s replug, 8s fault "
            "noise=0.02, 1m clear"};
    }
    auto command = parse_fault_command(text.substr(end));
    if (!command) {
        auto problem = std::move(command).error();
        problem.cause = fmt::format("\"{}\" in the schedule: {}", text, problem.cause);
        return problem;
    }
    return Entry{*at, std::move(*command)};
}

Result<void, Problem> FaultSchedule::add(std::string_view text) {
    auto entries = entries_;
    while (true) {
        const auto comma = text.find(',');
        auto entry = parse_entry(trimmed(text.substr(0, comma)));
        if (!entry) {
            return std::move(entry).error();
        }
        entries.push_back(std::move(*entry));
        if (comma == std::string_view::npos) {
            break;
        }
        text.remove_prefix(comma + 1);
    }
    std::ranges::stable_sort(entries, {}, &Entry::at);
    entries_ = std::move(entries);
    return {};
}

std::optional<milliseconds> FaultSchedule::next_due() const {
    return taken_ < entries_.size() ? std::optional(entries_[taken_].at) : std::nullopt;
}

std::optional<FaultCommand> FaultSchedule::take_due(std::chrono::nanoseconds since_start) {
    const auto due = next_due();
    if (!due || since_start < *due) {
        return std::nullopt;
    }
    return entries_[taken_++].command;
}

}  // namespace sweepcast::virtual_lidar
