// ScanMode: one way a lidar can scan, and which of them to take.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/request.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::device {

struct ScanMode {
    std::string name;
    protocol::AnswerType answer_type{};
    /// From one sample to the next; 0 if the lidar does not say.
    std::chrono::nanoseconds sample_duration{};
    /// What the lidar calls it by; unset for a lidar that lists no modes.
    std::optional<std::uint16_t> id{};
    /// Samples beyond it are no echoes; 0 if not known.
    double max_distance_mm{};
    /// The one that the lidar recommends.
    bool typical{};

    [[nodiscard]] double samples_per_second() const {
        return sample_duration.count() > 0 ? 1e9 / static_cast<double>(sample_duration.count())
                                           : 0.0;
    }
};

/// The modes of a lidar that answers GET_SAMPLERATE: Standard, and Express from firmware 1.17 on
/// (protocol.md 2, 4.4).
[[nodiscard]] std::vector<ScanMode>
legacy_modes(const protocol::DeviceInfo& info, const protocol::SampleRate& rate);

/// The request that starts a scan in this mode.
[[nodiscard]] protocol::Request scan_request(const ScanMode& mode);

/// The mode called `name` (upper or lower case), else the one of that id, or nullptr.
[[nodiscard]] const ScanMode* find_mode(const std::vector<ScanMode>& modes, std::string_view name);

/// The mode to take when nobody asks for one: the lidar's typical one, else the one with the most
/// samples a second; nullptr if there is none.
[[nodiscard]] const ScanMode* best_mode(const std::vector<ScanMode>& modes);

}  // namespace sweepcast::device
