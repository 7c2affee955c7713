// SpeedRegulator: makes a lidar turn as fast as its user wants, and says how far it got. Pure: what
// to tell the motor comes out, the time of each revolution goes in.
#pragma once

#include "driver/device/motor_traits.hpp"
#include "driver/device/rotation.hpp"
#include "driver/device/speedometer.hpp"

#include <chrono>
#include <cstdint>
#include <string>

namespace sweepcast::device {

/// The greatest duty of an accessory board.
inline constexpr std::uint16_t full_duty = 1023;

/// A motor that knows its speed (rpm) is told it once. Behind an accessory board only the duty can
/// be set, and what speed that gives differs from unit to unit: the loop is closed here. It waits
/// until the speed is steady, then scales the duty by wanted/measured, and again until the speed is
/// within 0.5 %. Waiting makes it independent of how slowly the motor follows; scaling converges as
/// long as more duty means more speed. A speed that drifts away later is corrected likewise.
class SpeedRegulator {
public:
    explicit SpeedRegulator(const MotorTraits& traits) : traits_(traits) { want(0.0); }

    /// Turns a second that are wanted from now on; 0: the lidar's usual speed.
    void want(double hz);

    /// Takes the time of a revolution in. setting() may change: the motor wants to know.
    void observe(std::chrono::microseconds revolution);

    /// The motor was stopped: what was measured is no longer so.
    void stopped();

    /// What to tell the motor to turn: rpm, or duty of full_duty; 0 where nothing can be told.
    [[nodiscard]] std::uint16_t setting() const { return setting_; }

    /// All that can be said of the speed.
    [[nodiscard]] Rotation rotation() const;

private:
    [[nodiscard]] double usual_hz() const { return traits_.desired.rpm / 60.0; }
    [[nodiscard]] std::string warning() const;
    [[nodiscard]] bool steady() const;
    void correct();
    void note_failure();

    MotorTraits traits_;
    Speedometer speed_;
    double wish_hz_{};  ///< 0: none
    double wanted_hz_{};
    std::uint16_t setting_{};
    std::uint32_t since_wish_{};     ///< revolutions, counted up to a bound
    std::uint32_t since_setting_{};  ///< likewise since the motor was told
    bool settled_{};
    /// The speed that it keeps to instead of the wanted one; 0: it does not.
    double failed_at_hz_{};
};

}  // namespace sweepcast::device
