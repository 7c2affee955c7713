// DamageCount: how many packets a bad line has damaged, and how many of those no receiver can tell.
#pragma once

#include "driver/protocol/answer_type.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::virtual_lidar {

struct DamageCounters {
    std::uint64_t packets{};  ///< sent whole or in part
    std::uint64_t damaged{};  ///< of those; a byte of each was changed, lost or doubled
    /// Runs of arrived bytes that hold damage, or the place of it, and pass as a packet all the
    /// same: their checksum is right by chance, or, in 0x81, their check bits are. Such a run may
    /// be made of parts of two packets. Every place is looked at, so a receiver that keeps in step
    /// is fooled by some of them only.
    std::uint64_t undetectable{};

    bool operator==(const DamageCounters&) const = default;
};

/// Compares what is sent of measurement streams with what arrives of it.
class DamageCount {
public:
    /// A stream of packets of this type begins. A packet of the last one that was cut off is not
    /// damaged by the line.
    void begin(protocol::AnswerType answer);

    /// `arrived` is what arrived of `sent`, the next byte of the stream.
    void pass(std::uint8_t sent, std::span<const std::uint8_t> arrived);

    /// The same for bytes of which each arrived as it was sent.
    void pass_unchanged(std::span<const std::uint8_t> sent);

    /// These bytes arrived in the midst of the stream and belong to none of its packets.
    void insert(std::span<const std::uint8_t> arrived);

    [[nodiscard]] const DamageCounters& counters() const { return counters_; }

private:
    void take(std::uint8_t byte);
    void make_room(std::size_t count);
    [[nodiscard]] bool passes() const;

    protocol::AnswerType answer_{};
    std::size_t packet_size_{};         // 0: no stream yet
    std::size_t position_{};            // in the packet being sent
    bool damaged_{};                    // the packet being sent
    bool gap_{};                        // bytes were lost since the last one that arrived
    std::vector<std::uint8_t> window_;  // the last bytes that arrived; a packet, or more
    std::size_t since_damage_{};  // bytes of it from the last damage on; the first may be past it
    DamageCounters counters_;
};

}  // namespace sweepcast::virtual_lidar
