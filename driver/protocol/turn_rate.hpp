// TurnRate: how far a scanner turns per packet, learnt from clean packets and used to judge those
// around damage.
#pragma once

#include <cstdint>
#include <optional>

namespace sweepcast::protocol {

/// The rate is steady once it was the same within 1/16 three times in a row. A rotor's inertia lets
/// it change only slowly from packet to packet, so a single turn of twice the rate or more means
/// that packets were lost, while two such turns in a row mean that the speed really is another one.
class TurnRate {
public:
    /// Learns from two packets with nothing between them how far the second is turned from the
    /// first (any angle unit) and says how many packet times that was: 1, or more if packets
    /// between them must have been lost without a trace; nothing if the rate that it knows does not
    /// tell.
    [[nodiscard]] std::optional<std::int32_t> learn(std::int32_t turned);

    /// How many packet times such a turn takes; nothing if the rate is not known or the turn is not
    /// within 1/8 of a packet's turn of a whole number of packets.
    [[nodiscard]] std::optional<std::int32_t> packet_times(std::int32_t turned) const;

    /// Whether the rate is known.
    [[nodiscard]] bool steady() const { return agreements_ >= 2; }

    /// Starts over: the scanner did.
    void forget() { *this = {}; }

private:
    std::int32_t rate_{};  ///< the last one believed
    int agreements_{};     ///< how often it was confirmed, counted up to 2
    std::int32_t
        doubt_{};  ///< a turn that contradicted a steady rate, until the next decides; or 0
};

/// The rate of two turns in a row, if they agree within 1/16.
[[nodiscard]] std::optional<std::int32_t> common_rate(std::int32_t turned, std::int32_t then);

/// How many packet times a turn took soon before the rate was this. One if it is less, since
/// scanners spin up; nothing if it is more and, within 1/8 of the rate, no whole number.
[[nodiscard]] std::optional<std::int32_t> packet_times_at(std::int32_t rate, std::int32_t turned);

}  // namespace sweepcast::protocol
