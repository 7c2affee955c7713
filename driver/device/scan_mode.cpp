#include "driver/device/scan_mode.hpp"

#include <algorithm>
#include <cctype>

namespace sweepcast::device {

namespace {

/// Firmware from which on EXPRESS_SCAN and GET_SAMPLERATE exist (protocol.md 2).
constexpr unsigned express_since = 0x0111;

bool equal_but_for_case(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, [](unsigned char x, unsigned char y) {
        return std::tolower(x) == std::tolower(y);
    });
}

}  // namespace

std::vector<ScanMode>
legacy_modes(const protocol::DeviceInfo& info, const protocol::SampleRate& rate) {
    std::vector<ScanMode> modes{
        {.name = "Standard",
         .answer_type = protocol::AnswerType::normal,
         .sample_duration = rate.standard}};
    const unsigned firmware = info.firmware_major * 256U + info.firmware_minor;
    if (firmware >= express_since) {
        modes.push_back(
            {.name = "Express",
             .answer_type = protocol::AnswerType::express,
             .sample_duration = rate.express}
        );
    }
    return modes;
}

protocol::Request scan_request(const ScanMode& mode) {
    // Working mode 0 is the legacy express scan, which every firmware that has EXPRESS_SCAN knows.
    return mode.answer_type == protocol::AnswerType::normal
               ? protocol::Request{protocol::Command::scan, {}}
               : protocol::express_scan_request(0);
}

const ScanMode* find_mode(const std::vector<ScanMode>& modes, std::string_view name) {
    const auto found = std::ranges::find_if(modes, [&](const ScanMode& mode) {
        return equal_but_for_case(mode.name, name);
    });
    return found == modes.end() ? nullptr : &*found;
}

const ScanMode* fastest_mode(const std::vector<ScanMode>& modes) {
    const auto fastest = std::ranges::max_element(modes, {}, &ScanMode::samples_per_second);
    return fastest == modes.end() ? nullptr : &*fastest;
}

}  // namespace sweepcast::device
