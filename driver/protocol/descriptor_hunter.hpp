// DescriptorHunter: finds the response descriptor that was asked for in whatever else the line
// carries.
#pragma once

#include "driver/protocol/answer_type.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace sweepcast::protocol {

/// Bytes of a response descriptor on the line.
inline constexpr std::size_t descriptor_size = 7;

/// The most that one answer packet may hold. None known is longer than 781 bytes.
inline constexpr std::uint32_t max_packet_length = 1024;

/// What opens every answer (protocol.md 1.3).
struct Descriptor {
    std::uint32_t length{};  ///< bytes of one data packet, below 2^30
    bool many{};             ///< packets follow until the next request, not just one
    std::uint8_t type{};     ///< an AnswerType or a ReplyType
    bool operator==(const Descriptor&) const = default;
};

/// The bytes of a descriptor: `A5 5A`, length and mode, type. Length is cut to 30 bits.
[[nodiscard]] std::array<std::uint8_t, descriptor_size> encode_descriptor(
    const Descriptor& descriptor
);

/// Which descriptors can answer a request.
class Expectation {
public:
    /// The one packet that answers GET_INFO, GET_HEALTH, ...: its type with the lengths it may
    /// have.
    [[nodiscard]] static Expectation reply(ReplyType type);
    /// Any measurement stream, each with the packet size of its type.
    [[nodiscard]] static Expectation measurement();

    [[nodiscard]] static Expectation device_info() { return reply(ReplyType::device_info); }
    [[nodiscard]] static Expectation health() { return reply(ReplyType::health); }
    [[nodiscard]] static Expectation sample_rate() { return reply(ReplyType::sample_rate); }
    [[nodiscard]] static Expectation lidar_conf() { return reply(ReplyType::lidar_conf); }
    [[nodiscard]] static Expectation set_lidar_conf() { return reply(ReplyType::set_lidar_conf); }
    [[nodiscard]] static Expectation acc_board_flag() { return reply(ReplyType::acc_board_flag); }

    /// Whether `descriptor` is one of those expected.
    [[nodiscard]] bool admits(const Descriptor& descriptor) const;

private:
    struct Form {
        std::uint8_t type{};
        bool many{};
        std::uint32_t min_length{};
        std::uint32_t max_length{};
    };
    std::array<Form, 6> forms_{};
    std::size_t count_{};
};

/// Hunts for a descriptor byte by byte in a window of seven; allocates nothing, trusts no length.
///
/// Junk, leftovers of a stopped stream, a doubled A5 and an `A5 5A` that turns out implausible
/// (wrong type, length or mode) are stepped over one byte at a time, so no true descriptor is
/// hidden behind them.
class DescriptorHunter {
public:
    explicit DescriptorHunter(const Expectation& expectation) : expectation_(expectation) {}

    struct Step {
        std::size_t consumed{};           ///< bytes taken; when found, the packet begins after them
        std::optional<Descriptor> found;  ///< nothing: all bytes were taken and more are needed
    };

    /// Takes bytes up to and including the first expected descriptor. Source:
    /// protocol.md 1.4, 13.1-3.
    [[nodiscard]] Step push(std::span<const std::uint8_t> bytes);

    /// Bytes passed so far that belonged to no expected descriptor.
    [[nodiscard]] std::uint64_t skipped() const { return skipped_; }

private:
    [[nodiscard]] bool plausible() const;
    [[nodiscard]] Descriptor descriptor_in_window() const;
    void drop_first();

    Expectation expectation_;
    std::array<std::uint8_t, descriptor_size> window_{};
    std::size_t filled_{};
    std::uint64_t skipped_{};
};

}  // namespace sweepcast::protocol
