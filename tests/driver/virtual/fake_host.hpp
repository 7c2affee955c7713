// FakeHost: talks to an emulator in made-up time and keeps what comes back.
#pragma once

#include "driver/protocol/request.hpp"
#include "driver/virtual/emulator.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepcast::virtual_lidar {

using Bytes = std::vector<std::uint8_t>;

/// The serial number of the scanners in tests.
inline constexpr SerialNumber test_serial{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

/// A world all round, a point every 0.1 degrees, in which no two neighbours are the same.
inline std::shared_ptr<const World> test_world() {
    std::string text = "angle_deg,distance_mm\n";
    for (int i = 0; i < 3600; ++i) {
        text += std::to_string(i / 10) + "." + std::to_string(i % 10) + "," +
                std::to_string(500 + (i * 7) % 5000) + "\n";
    }
    return std::make_shared<const World>(*PolarMap::parse(text, "test"));
}

class FakeHost {
public:
    using Duration = std::chrono::nanoseconds;

    explicit FakeHost(std::shared_ptr<const World> world = test_world())
        : FakeHost("a1m8", {}, std::move(world)) {}

    explicit FakeHost(
        std::string_view key,
        const EmulatorSettings& settings = {},
        std::shared_ptr<const World> world = test_world()
    )
        : persona(*find_persona(key))
        , emulator(
              persona,
              test_serial,
              Beam(std::move(world), persona.beam, {.noise_mm = 0.0}),
              now,
              [this](const Event& event) { events.push_back(event.what); },
              settings
          ) {}

    /// Sends bytes and takes what has come until now.
    void send(const Bytes& bytes) {
        emulator.receive(bytes, now);
        take();
    }
    void send(protocol::Command command, Bytes payload = {}) {
        send(protocol::encode({command, std::move(payload)}));
    }

    /// Lets time pass in steps, as the virtual lidar does.
    void run(Duration duration, Duration step = std::chrono::milliseconds(1)) {
        const auto end = now + duration;
        while (now < end) {
            now = std::min(now + step, end);
            emulator.advance(now);
            take();
        }
    }

    /// Runs until the motor is up to speed.
    void spin_up() { run(persona.motor.spin_up); }

    /// Switches the motor on, as hosts of this persona do, and runs until it is up to speed.
    void switch_on_and_spin_up() {
        using protocol::MotorControl;
        if (persona.motor.control == MotorControl::accessory_board) {
            send(protocol::encode(protocol::set_motor_pwm_request(persona.rotation.pwm_reference)));
        } else if (persona.motor.control == MotorControl::rpm) {
            send(protocol::encode(protocol::motor_rpm_request(persona.rotation.desired_rpm)));
        }
        run(persona.motor.spin_up * 3 / 2);
    }

    /// Everything received so far, and forgets it.
    Bytes received() {
        Bytes all;
        for (const auto& part : std::exchange(transmitted, {})) {
            all.insert(all.end(), part.bytes.begin(), part.bytes.end());
        }
        return all;
    }

    /// The measurement bytes received so far; forgets everything.
    Bytes measurements() {
        Bytes found;
        for (const auto& part : std::exchange(transmitted, {})) {
            if (part.payload == Payload::measurement) {
                found.insert(found.end(), part.bytes.begin(), part.bytes.end());
            }
        }
        return found;
    }

    const Persona& persona;
    Moment now{std::chrono::hours(1)};
    std::vector<Transmitted> transmitted;
    std::vector<Occurrence> events;
    Emulator emulator;

private:
    void take() { emulator.take(now, transmitted); }
};

}  // namespace sweepcast::virtual_lidar
