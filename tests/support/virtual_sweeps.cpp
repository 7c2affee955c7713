#include "tests/support/virtual_sweeps.hpp"

#include "driver/device/scan_mode.hpp"
#include "driver/device/scan_reader.hpp"
#include "driver/protocol/request.hpp"
#include "driver/virtual/beam.hpp"
#include "driver/virtual/emulator.hpp"
#include "driver/virtual/persona.hpp"

#include <chrono>
#include <string>
#include <utility>

namespace sweepcast::test {

namespace {

using namespace virtual_lidar;
using namespace std::chrono_literals;

device::ScanMode host_mode(const Persona& persona, const virtual_lidar::ScanMode& mode) {
    device::ScanMode result;
    result.name = std::string(mode.name);
    result.answer_type = mode.answer;
    result.sample_duration = mode.sample_duration();
    result.id = static_cast<std::uint16_t>(&mode - persona.modes.data());
    result.max_distance_mm = mode.max_distance_q8_m * 1000.0 / 256.0;
    return result;
}

/// A scanner that is up to speed and scans.
class Scanner {
public:
    Scanner(
        const Persona& persona,
        const device::ScanMode& mode,
        std::shared_ptr<const World> world,
        std::uint64_t seed
    )
        : emulator_(
              persona,
              serial_from(persona.key),
              Beam(std::move(world), persona.beam, {.seed = seed}),
              now_,
              [](const Event&) {},
              {.seed = seed}
          ) {
        using protocol::MotorControl;
        if (persona.motor.control == MotorControl::accessory_board) {
            tell(protocol::set_motor_pwm_request(persona.rotation.pwm_reference));
        } else if (persona.motor.control == MotorControl::rpm) {
            tell(protocol::motor_rpm_request(persona.rotation.desired_rpm));
        }
        for (const auto ready = now_ + persona.motor.spin_up * 2; now_ < ready;) {
            (void)wait();
        }
        tell(device::scan_request(mode));
    }

    /// What comes in the next millisecond.
    const std::vector<Transmitted>& wait() {
        now_ += 1ms;
        emulator_.advance(now_);
        transmitted_.clear();
        emulator_.take(now_, transmitted_);
        return transmitted_;
    }

    [[nodiscard]] protocol::SampleTime now() const {
        return protocol::SampleTime(
            std::chrono::duration_cast<std::chrono::microseconds>(now_.time_since_epoch())
        );
    }

private:
    void tell(const protocol::Request& request) {
        emulator_.receive(protocol::encode(request), now_);
    }

    Moment now_{1h};
    std::vector<Transmitted> transmitted_;
    Emulator emulator_;
};

device::CapturedSweep
captured(protocol::Sweep sweep, const Persona& persona, const device::ScanMode& mode) {
    device::CapturedSweep result;
    result.sweep = std::move(sweep);
    result.lidar = protocol::short_serial_text(serial_from(persona.key));
    result.lidar_number = 1;
    result.mode = mode.name;
    result.answer_type = mode.answer_type;
    result.sample_duration = mode.sample_duration;
    result.monotonic_to_unix = 1'700'000'000s;
    return result;
}

}  // namespace

VirtualSweeps virtual_sweeps(
    const VirtualScanner& scanner,
    std::shared_ptr<const World> world,
    std::size_t count,
    std::uint64_t seed
) {
    const auto& persona = *find_persona(scanner.model);
    const auto mode = host_mode(persona, *find_mode(persona, scanner.type));
    Scanner playing(persona, mode, std::move(world), seed);
    const std::uint32_t baud = persona.connection == Connection::serial ? persona.baud : 0;
    device::LineQuality line;
    auto reader = device::ScanReader::create(scanner.type, mode, baud, line).value();
    VirtualSweeps result;
    std::vector<protocol::Sweep> finished;
    while (result.sweeps.size() < count) {
        for (const auto& part : playing.wait()) {
            if (part.payload == Payload::measurement) {
                reader.push(part.bytes, playing.now(), finished);
            }
        }
        for (auto& sweep : std::exchange(finished, {})) {
            if (result.sweeps.size() < count) {
                result.sweeps.push_back(captured(std::move(sweep), persona, mode));
                result.sweeps.back().sequence = result.sweeps.size();
            }
        }
    }
    result.line_bytes_per_sample =
        static_cast<double>(line.bytes) / static_cast<double>(line.samples);
    return result;
}

}  // namespace sweepcast::test
