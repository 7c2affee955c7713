// A scan over a line that delays, in made-up time: what the host reads and when, and when each
// sample was truly taken.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/sample.hpp"
#include "driver/virtual/persona.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace sweepcast::test {

/// How a line delivers the packets of a scanner.
struct LineModel {
    std::string_view name{};
    /// The host sees bytes when it polls, so often; 0: as soon as a packet is complete.
    std::chrono::nanoseconds poll{};
    /// Besides, it is late by anything up to this.
    std::chrono::nanoseconds jitter{};
    /// How much slower than it says the scanner's clock goes, in millionths.
    double crystal_ppm{};
    double lost{};     ///< part of the packets that never arrive
    double damaged{};  ///< part of them in which a byte is changed
    /// Nothing is sent for so long, once, in the middle.
    std::chrono::nanoseconds pause{};
};

struct LineRead {
    protocol::SampleTime at;
    std::vector<std::uint8_t> bytes;
};

/// A scan of the virtual lidar as a host sees it.
class LineScan {
public:
    /// Of the first mode with that answer type of the model `key`, for `length`.
    LineScan(
        std::string_view key,
        protocol::AnswerType type,
        const LineModel& model,
        std::chrono::nanoseconds length
    );

    [[nodiscard]] const std::vector<LineRead>& reads() const { return reads_; }
    /// As the scanner tells it, exactly.
    [[nodiscard]] std::chrono::nanoseconds sample_duration() const { return sample_duration_; }
    [[nodiscard]] std::uint32_t baud() const { return baud_; }

    /// When this sample was truly taken, within some microseconds: when the head last pointed, or
    /// next will point, where the sample says, nearest to the time that it has.
    [[nodiscard]] double true_time_us(const protocol::Sample& sample) const;

private:
    struct Packet {
        double start_us{};  ///< of the first sample, on the host's clock
        double end_us{};    ///< of the first of the next packet
        double start_turns{};
        double end_turns{};
    };
    [[nodiscard]] const Packet& packet_at(double time_us) const;
    void find_offset(
        const std::vector<std::uint8_t>& bytes,
        protocol::AnswerType type,
        std::size_t per_packet
    );

    std::vector<LineRead> reads_;
    std::vector<Packet> packets_;
    std::chrono::nanoseconds sample_duration_{};
    std::uint32_t baud_{};
    double offset_turns_{};  ///< of what a decoder makes of the angles
};

}  // namespace sweepcast::test
