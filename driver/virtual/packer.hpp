// Packers: the samples of one packet, measured and packed as an answer type does it. A file each.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/units.hpp"
#include "driver/virtual/beam.hpp"
#include "driver/virtual/motor.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace sweepcast::virtual_lidar {

/// The stretch that the head covers from the first sample of a packet to that of the next.
struct Stretch {
    std::size_t samples{};  ///< evenly spread over it
    double start_turns{};   ///< turns made at the first sample
    double end_turns{};     ///< ... and at the first one of the next packet
    double turns_before{};  ///< ... and at the last sample before; `start_turns` if there is none
    bool restarted{};       ///< it is the first of a stream
    Seconds start_time{};   ///< of the first sample, since the scanner was switched on
    Seconds sample_duration{};
    double max_distance_mm{};  ///< of the scan mode

    [[nodiscard]] protocol::AngleQ6 start_angle() const;
    [[nodiscard]] protocol::AngleQ6 end_angle() const;

    /// The angle of sample `k` in 1/65536 degree, not wrapped, as receivers of capsules will spread
    /// it from the start angles: not where the head was, but where they believe it was (protocol.md
    /// 7.2). `k` may be `samples`.
    [[nodiscard]] std::int64_t spread_q16(std::size_t k) const;

    /// Turns made at sample `k`.
    [[nodiscard]] double turns(std::size_t k) const;
    [[nodiscard]] Seconds time(std::size_t k) const;

    /// Sample `k`, taken in this direction, as far as the scan mode and `field_mm`, the most that
    /// a packet can tell, go: no echo beyond.
    [[nodiscard]] Echo measure(Beam& beam, double angle_deg, std::size_t k, double field_mm) const;
};

/// The direction that a receiver gets from an angle in 1/65536 degree: cut to 1/64 (protocol.md
/// 7.3, 7.5, 7.6).
[[nodiscard]] double received_degrees(std::int64_t raw_q16);

class Packer {
public:
    virtual ~Packer() = default;

    /// How many samples a packet has.
    [[nodiscard]] virtual std::size_t samples() const = 0;

    /// Measures along `stretch` and gives the bytes of the packet; they are valid until the next
    /// call. Stretches follow each other without a gap.
    virtual const std::vector<std::uint8_t>& pack(const Stretch& stretch, Beam& beam) = 0;
};

[[nodiscard]] std::unique_ptr<Packer> make_normal_packer();
[[nodiscard]] std::unique_ptr<Packer> make_express_packer();
[[nodiscard]] std::unique_ptr<Packer> make_hq_packer();
[[nodiscard]] std::unique_ptr<Packer> make_ultra_packer();
[[nodiscard]] std::unique_ptr<Packer> make_dense_packer();
[[nodiscard]] std::unique_ptr<Packer> make_ultra_dense_packer();

/// The packer of an answer type. Throws std::invalid_argument for a value that is none.
[[nodiscard]] std::unique_ptr<Packer> make_packer(protocol::AnswerType type);

}  // namespace sweepcast::virtual_lidar
