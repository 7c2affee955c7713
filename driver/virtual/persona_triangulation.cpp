// The A series: triangulating scanners, and one of them with firmware that knows little.
//
// From protocol.md 5 and 6: model numbers, baud rates, how motors are controlled, modes of the A1
// and A3. Assumed, because nothing tells: the modes of the A2M8 beyond the third, and the A2M12's,
// which are those of its sister A2M7 at the range in its name; the typical modes of both; beams;
// times of motors, answers and boots but for the A1's.
#include "driver/virtual/persona_families.hpp"

#include <array>

namespace sweepcast::virtual_lidar {

namespace {

using namespace std::chrono_literals;
using protocol::AnswerType;
using protocol::MotorControl;

// As an A1 of firmware 1.24 and later reports them (protocol.md 6).
constexpr std::array a1m8_modes{
    ScanMode{"Standard", AnswerType::normal, 500U * 256U, 12U * 256U},
    ScanMode{"Express", AnswerType::express, 250U * 256U, 12U * 256U},
    ScanMode{"Boost", AnswerType::ultra, 125U * 256U, 12U * 256U},
};

// Launch files start an A2M8 in "Sensitivity".
constexpr std::array a2m8_modes{
    ScanMode{"Standard", AnswerType::normal, 500U * 256U, 12U * 256U},
    ScanMode{"Express", AnswerType::express, 250U * 256U, 12U * 256U},
    ScanMode{"Boost", AnswerType::ultra, 125U * 256U, 12U * 256U},
    ScanMode{"Sensitivity", AnswerType::ultra, 125U * 256U, 12U * 256U},
};

// Nobody can ask for these: firmware before 1.24 does not answer GET_LIDAR_CONF.
constexpr std::array a2m8_old_modes{
    ScanMode{"Standard", AnswerType::normal, 500U * 256U, 16U * 256U},
    ScanMode{"Express", AnswerType::express, 250U * 256U, 16U * 256U},
};

constexpr std::array a2m12_modes{
    ScanMode{"Standard", AnswerType::normal, 252U * 256U, 12U * 256U},
    ScanMode{"Express", AnswerType::express, 126U * 256U, 12U * 256U},
    ScanMode{"Boost", AnswerType::ultra, 63U * 256U, 12U * 256U},
    ScanMode{"Sensitivity", AnswerType::ultra, 63U * 256U, 12U * 256U},
};

constexpr std::array a3m1_modes{
    ScanMode{"Standard", AnswerType::normal, 252U * 256U, 25U * 256U},
    ScanMode{"Express", AnswerType::express, 126U * 256U, 25U * 256U},
    ScanMode{"Boost", AnswerType::ultra, 63U * 256U, 25U * 256U},
    ScanMode{"Sensitivity", AnswerType::ultra, 63U * 256U, 25U * 256U},
    ScanMode{"Stability", AnswerType::ultra, 100U * 256U, 25U * 256U},
};

// 5.5 turns a second is what the belt of an A1 gives at 5 V. Nothing regulates it: the speeds that
// it reports are references for an accessory board, which it does not have.
constexpr MotorTraits belt{
    .control = MotorControl::modem_line,
    .rotation_hz = 5.5,
    .spin_up = 1000ms,
    .coast_down = 1500ms,
    .ripple = 0.005};

// Ten turns a second at the reference duty, more or less: see speed_at_pwm().
constexpr MotorTraits board{
    .control = MotorControl::accessory_board,
    .rotation_hz = 10.0,
    .spin_up = 1200ms,
    .coast_down = 2000ms,
    .ripple = 0.004};

constexpr RotationConf board_rotation{
    .desired_rpm = 600,
    .pwm_reference = 660,
    .min_rpm = 300,
    .max_rpm = 900};

constexpr BeamTraits triangulation_beam(double max_distance_mm) {
    return {
        .min_distance_mm = 150.0,
        .max_distance_mm = max_distance_mm,
        .noise_floor_mm = 1.5,
        .noise_part = 0.002};
}

// What they say while booting has three lines (protocol.md 11.2).
constexpr std::array triangulating{
    Persona{
        .key = "a1m8",
        .title = "RPLIDAR A1M8",
        .model = 0x18,
        .firmware_major = 1,
        .firmware_minor = 29,
        .hardware = 7,
        .baud = 115'200,
        .motor = belt,
        .beam = triangulation_beam(12'000.0),
        .rotation = board_rotation,
        .modes = a1m8_modes,
        .typical_mode = 1,
        .boot_text = "RP LIDAR System.\r\nFirmware Ver 1.29 - rtm, HW Ver 7\r\nModel: 18\r\n",
        .boot_time = 10ms,
        .answer_time = 500us,
    },
    Persona{
        .key = "a2m8",
        .title = "RPLIDAR A2M8",
        .model = 0x28,
        .firmware_major = 1,
        .firmware_minor = 25,
        .hardware = 5,
        .baud = 115'200,
        .motor = board,
        .beam = triangulation_beam(12'000.0),
        .rotation = board_rotation,
        .modes = a2m8_modes,
        .typical_mode = 3,
        .boot_text = "RP LIDAR System.\r\nFirmware Ver 1.25 - rtm, HW Ver 5\r\nModel: 28\r\n",
        .boot_time = 15ms,
        .answer_time = 500us,
    },
    Persona{
        .key = "a2m8-old",
        .title = "RPLIDAR A2M8 (firmware 1.20)",
        .model = 0x28,
        .firmware_major = 1,
        .firmware_minor = 20,
        .hardware = 4,
        .baud = 115'200,
        .motor = board,
        .beam = triangulation_beam(16'000.0),
        .rotation = board_rotation,
        .modes = a2m8_old_modes,
        .typical_mode = 1,
        .boot_text = "RP LIDAR System.\r\nFirmware Ver 1.20 - rtm, HW Ver 4\r\nModel: 28\r\n",
        .boot_time = 15ms,
        .answer_time = 800us,
    },
    Persona{
        .key = "a2m12",
        .title = "RPLIDAR A2M12",
        .model = 0x2C,
        .firmware_major = 1,
        .firmware_minor = 32,
        .hardware = 6,
        .baud = 256'000,
        .motor = board,
        .beam = triangulation_beam(12'000.0),
        .rotation = board_rotation,
        .modes = a2m12_modes,
        .typical_mode = 3,
        .boot_text = "RP LIDAR System.\r\nFirmware Ver 1.32 - rtm, HW Ver 6\r\nModel: 2C\r\n",
        .boot_time = 15ms,
        .answer_time = 400us,
    },
    Persona{
        .key = "a3m1",
        .title = "RPLIDAR A3M1",
        .model = 0x31,
        .firmware_major = 1,
        .firmware_minor = 26,
        .hardware = 6,
        .alias = "A3M1",
        .baud = 256'000,
        .motor = board,
        .beam = triangulation_beam(25'000.0),
        .rotation = board_rotation,
        .modes = a3m1_modes,
        .typical_mode = 3,
        .boot_text = "RP LIDAR System.\r\nFirmware Ver 1.26 - rtm, HW Ver 6\r\nModel: 31\r\n",
        .boot_time = 15ms,
        .answer_time = 400us,
    },
};

}  // namespace

std::span<const Persona> triangulation_personas() {
    return triangulating;
}

}  // namespace sweepcast::virtual_lidar
