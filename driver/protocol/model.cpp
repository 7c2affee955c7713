// Model numbers: names, families and what they can do.
#include "driver/protocol/model.hpp"

#include <algorithm>
#include <array>

namespace sweepcast::protocol {
namespace {

struct FamilyRange {
    int first;  // the family's first value of the high nibble
    int below;  // what to subtract from the high nibble for the generation
    Family family;
    char letter;
};

FamilyRange range_of(std::uint8_t model) {
    constexpr std::array<FamilyRange, 5> ranges{
        {{12, 11, Family::m, 'M'},
         {9, 8, Family::t, 'T'},
         {6, 5, Family::s, 'S'},
         {4, 3, Family::c, 'C'},
         {0, 0, Family::a, 'A'}}};
    const int series = model >> 4;
    return *std::find_if(ranges.begin(), ranges.end(), [series](const FamilyRange& each) {
        return series >= each.first;
    });
}

/// Newer families count their firmware from 1.0 again: only that of the A models says anything.
bool at_least(const DeviceInfo& info, unsigned firmware_of_a_models) {
    const unsigned firmware = info.firmware_major * 256U + info.firmware_minor;
    return family_of(info.model) != Family::a || firmware >= firmware_of_a_models;
}

}  // namespace

Family family_of(std::uint8_t model) {
    return range_of(model).family;
}

std::string model_name(std::uint8_t model) {
    const auto range = range_of(model);
    return range.letter + std::to_string((model >> 4) - range.below) + 'M' +
           std::to_string(model & 0x0F);
}

MotorControl motor_control_of(std::uint8_t model) {
    switch (family_of(model)) {
    case Family::a:
        return model >= 0x20 ? MotorControl::accessory_board : MotorControl::modem_line;
    case Family::c:
        return MotorControl::self;
    case Family::s:
    case Family::t:
    case Family::m:
        return MotorControl::rpm;
    }
    return MotorControl::modem_line;
}

bool knows_lidar_conf(const DeviceInfo& info) {
    return at_least(info, 0x0118);
}

bool knows_express(const DeviceInfo& info) {
    return at_least(info, 0x0111);
}

bool knows_baud_negotiation(const DeviceInfo& info) {
    return at_least(info, 0x011E);
}

}  // namespace sweepcast::protocol
