// What the checks of talking to a lidar say: is it heard, does it answer, who and how is it. Pure.
#pragma once

#include "driver/device/scan_mode.hpp"
#include "driver/diagnosis/finding.hpp"
#include "driver/diagnosis/heard.hpp"
#include "driver/link/port_list.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/result.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace sweepcast::diagnosis {

/// What was heard at each line speed, in the order they were tried.
struct LineLook {
    std::string url;                          ///< as the user named it
    bool network{};                           ///< no line speed: one entry in `heard`
    std::optional<std::uint32_t> asked_baud;  ///< the only speed that the user wants
    std::optional<link::SerialPort> adapter;
    std::vector<Heard> heard;

    /// The entry that tells most.
    [[nodiscard]] const Heard& best() const;
};

/// The connection broke while one listened.
[[nodiscard]] Finding judge_broken_line(const LineLook& line, const error_code& failure);
/// `line.heard` is not empty.
[[nodiscard]] Finding judge_bytes(const LineLook& line);
/// Of a line that passed judge_bytes().
[[nodiscard]] Finding judge_descriptor(const LineLook& line);

/// Unset: an answer began but did not come whole.
[[nodiscard]] Finding
judge_info(const std::optional<protocol::DeviceInfo>& info, const std::string& alias);
/// An error: the question went unanswered.
[[nodiscard]] Finding judge_health(const Result<protocol::Health>& health);
/// An error: the lidar fell silent meanwhile.
[[nodiscard]] Finding judge_modes(const Result<std::vector<device::ScanMode>>& modes);

}  // namespace sweepcast::diagnosis
