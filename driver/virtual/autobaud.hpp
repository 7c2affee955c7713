// Autobaud: the scanner's side of the negotiation of a line speed (protocol.md 4.7).
#pragma once

#include "driver/virtual/motor.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace sweepcast::virtual_lidar {

/// Measures the speed of a host that sends 0x41 over and over, speaks that speed on trial, and
/// keeps it if the host confirms it.
class Autobaud {
public:
    /// `usual_baud` is what the scanner speaks when it starts.
    explicit Autobaud(std::uint32_t usual_baud);

    /// The speed that the scanner speaks.
    [[nodiscard]] std::uint32_t baud() const { return baud_; }

    /// Takes what arrived at `now` from a host that sends at `host_baud`. Gives the speed measured
    /// when there is one: the scanner speaks it from then on, and has to say it.
    std::optional<std::uint32_t>
    push(std::span<const std::uint8_t> bytes, std::uint32_t host_baud, Moment now);

    /// Takes the payload of NEW_BAUDRATE_CONFIRM: the speed on trial is kept if it is what was
    /// measured, by less than 5 %.
    void confirm(std::span<const std::uint8_t> payload);

    /// Back to the old speed if a trial ends unconfirmed.
    void advance(Moment now);

    /// When a trial ends; none if there is none.
    [[nodiscard]] std::optional<Moment> trial_ends() const;

    /// Back to the usual speed.
    void reset();

private:
    struct Trial {
        std::uint32_t old_baud{};
        Moment ends;
    };

    std::uint32_t usual_baud_;
    std::uint32_t baud_;
    std::optional<Trial> trial_;
    int run_{};  // of 0x41
    Moment run_grew_{};
};

}  // namespace sweepcast::virtual_lidar
