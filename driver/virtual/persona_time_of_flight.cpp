// The C, S and T series: scanners that measure the time of flight. None prints a boot text.
//
// From protocol.md 5 and 6: model numbers, baud rates, how motors are controlled, the modes of S1,
// S2 and C1 by name, range and rate, the S3's by name and range. Assumed, because nothing tells:
// which scanner uses answer types 0x83 and 0x86 (here the last mode of the S3 and of the C1), the
// S3's rates, all of the T1 but its model number, its connection and the name of its second mode,
// firmware of S1 and T1, typical modes but for the S2's; beams; times of motors, answers and boots
// but for the S1's boot.
#include "driver/virtual/persona_families.hpp"

#include <array>

namespace sweepcast::virtual_lidar {

namespace {

using namespace std::chrono_literals;
using protocol::AnswerType;
using protocol::MotorControl;

constexpr std::array c1_modes{
    ScanMode{"Standard", AnswerType::normal, 200U * 256U, 16U * 256U},
    ScanMode{"UltraDense", AnswerType::ultra_dense, 200U * 256U, 40U * 256U},
};

// 4.6 and 9.2 thousand samples a second.
constexpr std::array s1_modes{
    ScanMode{"Standard", AnswerType::normal, 55'652U, 16U * 256U},
    ScanMode{"DenseBoost", AnswerType::dense, 27'826U, 40U * 256U},
};

constexpr std::array s2_modes{
    ScanMode{"Standard", AnswerType::normal, 16'000U, 16U * 256U},
    ScanMode{"DenseBoost", AnswerType::dense, 8'000U, 30U * 256U},
};

constexpr std::array s3_modes{
    ScanMode{"Standard", AnswerType::normal, 16'000U, 16U * 256U},
    ScanMode{"DenseBoost", AnswerType::dense, 8'000U, 40U * 256U},
    ScanMode{"HQ", AnswerType::hq, 125U * 256U, 40U * 256U},
};

constexpr std::array t1_modes{
    ScanMode{"Standard", AnswerType::normal, 16'000U, 16U * 256U},
    ScanMode{"Sensitivity", AnswerType::dense, 8'000U, 40U * 256U},
};

constexpr MotorTraits spins_by_itself{
    .control = MotorControl::self,
    .rotation_hz = 10.0,
    .spin_up = 1000ms,
    .coast_down = 1500ms,
    .ripple = 0.002};

constexpr MotorTraits regulated{
    .control = MotorControl::rpm,
    .rotation_hz = 10.0,
    .spin_up = 1500ms,
    .coast_down = 2000ms,
    .ripple = 0.002};

constexpr RotationConf regulated_rotation{
    .desired_rpm = 600,
    .pwm_reference = 660,
    .min_rpm = 300,
    .max_rpm = 900};

constexpr BeamTraits time_of_flight_beam(double max_distance_mm) {
    return {
        .min_distance_mm = 50.0,
        .max_distance_mm = max_distance_mm,
        .noise_floor_mm = 4.0,
        .noise_part = 0.0005};
}

constexpr std::array timing{
    Persona{
        .key = "s1",
        .title = "RPLIDAR S1",
        .model = 0x61,
        .firmware_major = 1,
        .firmware_minor = 2,
        .hardware = 18,
        .baud = 256'000,
        .motor = regulated,
        .beam = time_of_flight_beam(40'000.0),
        .rotation = regulated_rotation,
        .modes = s1_modes,
        .typical_mode = 1,
        .boot_time = 2050ms,
        .answer_time = 400us,
    },
    Persona{
        .key = "s2",
        .title = "RPLIDAR S2",
        .model = 0x71,
        .firmware_major = 1,
        .firmware_minor = 2,
        .hardware = 18,
        .alias = "S2M1-R2L",
        .baud = 1'000'000,
        .motor = regulated,
        .beam = time_of_flight_beam(30'000.0),
        .rotation = regulated_rotation,
        .modes = s2_modes,
        .typical_mode = 1,
        .boot_time = 200ms,
        .answer_time = 200us,
    },
    Persona{
        .key = "s3",
        .title = "RPLIDAR S3",
        .model = 0x81,
        .firmware_major = 1,
        .firmware_minor = 2,
        .hardware = 18,
        .baud = 1'000'000,
        .motor = regulated,
        .beam = time_of_flight_beam(40'000.0),
        .rotation = regulated_rotation,
        .modes = s3_modes,
        .typical_mode = 1,
        .boot_time = 200ms,
        .answer_time = 200us,
    },
    Persona{
        .key = "c1",
        .title = "RPLIDAR C1",
        .model = 0x41,
        .firmware_major = 1,
        .firmware_minor = 2,
        .hardware = 18,
        .alias = "C1M1-R2",
        .baud = 460'800,
        .motor = spins_by_itself,
        .beam = time_of_flight_beam(40'000.0),
        .rotation = regulated_rotation,
        .modes = c1_modes,
        .typical_mode = 1,
        .boot_time = 200ms,
        .answer_time = 300us,
    },
    Persona{
        .key = "t1",
        .title = "RPLIDAR T1",
        .model = 0x91,
        .firmware_major = 1,
        .firmware_minor = 1,
        .hardware = 18,
        .connection = Connection::ethernet,
        .baud = 1'000'000,
        .motor = regulated,
        .beam = time_of_flight_beam(40'000.0),
        .rotation = regulated_rotation,
        .modes = t1_modes,
        .typical_mode = 1,
        .boot_time = 500ms,
        .answer_time = 300us,
    },
};

}  // namespace

std::span<const Persona> time_of_flight_personas() {
    return timing;
}

}  // namespace sweepcast::virtual_lidar
