// Faults: what can be wrong with a virtual lidar or its line, so that hosts can be seen to cope.
#pragma once

#include "driver/protocol/reply.hpp"
#include "driver/protocol/result.hpp"
#include "driver/virtual/random.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::virtual_lidar {

/// Which faults a scanner has. By default none.
struct Faults {
    bool mute{};              ///< it never says anything
    bool banner{};            ///< prints its boot text again and again, and answers nothing
    bool motor_stall{};       ///< it takes scan requests, but the motor never turns
    bool sample_time_zero{};  ///< it says that a sample takes 0 us (protocol.md 13.14)
    bool bare_echo{};         ///< it echoes GET_LIDAR_CONF without a value (protocol.md 13.15)
    bool junk{};              ///< noise before every descriptor (protocol.md 13.1, 13.2)
    bool leftovers{};         ///< it is scanning already, as after a crash of its host
    double noise{};           ///< part of the bytes to the host that are changed on the way, 0..1
    double drop{};            ///< part of the bytes to the host that are lost on the way, 0..1
    /// Bytes reach the host only so often, as behind a USB adapter (protocol.md 13.20); 0: at once.
    std::chrono::milliseconds burst{};
    protocol::Health health{};  ///< from the start and after each RESET
};

/// What a user can choose, for help texts: a line each, "name  what it does".
[[nodiscard]] std::string faults_help();

/// Adds the fault that `text` names to `faults`: "mute", "banner", "motor-stall",
/// "sample-time-zero", "bare-echo", "junk", "leftovers", "noise=RATE", "drop=RATE",
/// "burst" (also with "=MS", 1..1000), "protection-stop" or "warning", these two also with "=CODE"
/// (0..65535, or hex with 0x).
/// Errors: errc::invalid_option.
[[nodiscard]] Result<void, Problem> add_fault(Faults& faults, std::string_view text);

/// A line that changes and loses bytes.
class BadLine {
public:
    /// `noise` and `drop` are parts, 0..1. Same seed and same bytes, same damage.
    BadLine(double noise, double drop, std::uint64_t seed);

    [[nodiscard]] bool is_good() const { return noise_ <= 0.0 && drop_ <= 0.0; }

    /// What arrives of `bytes`.
    void damage(std::vector<std::uint8_t>& bytes);

private:
    double noise_;
    double drop_;
    Random random_;
};

/// What a scanner with `junk` sends before a descriptor. It ends in A5, so that the descriptor
/// makes it A5 A5 5A.
[[nodiscard]] std::span<const std::uint8_t> junk_before_descriptor();

}  // namespace sweepcast::virtual_lidar
