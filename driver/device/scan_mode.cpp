#include "driver/device/scan_mode.hpp"

#include "driver/protocol/model.hpp"

#include <algorithm>
#include <cctype>

namespace sweepcast::device {

namespace {

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
    if (protocol::knows_express(info)) {
        modes.push_back(
            {.name = "Express",
             .answer_type = protocol::AnswerType::express,
             .sample_duration = rate.express}
        );
    }
    return modes;
}

protocol::Request scan_request(const ScanMode& mode) {
    if (mode.answer_type == protocol::AnswerType::normal) {
        return {protocol::Command::scan, {}};
    }
    // Working mode 0 is the legacy express scan, which every firmware that has EXPRESS_SCAN knows.
    return protocol::express_scan_request(static_cast<std::uint8_t>(mode.id.value_or(0)));
}

const ScanMode* find_mode(const std::vector<ScanMode>& modes, std::string_view name) {
    const auto named = std::ranges::find_if(modes, [&](const ScanMode& mode) {
        return equal_but_for_case(mode.name, name);
    });
    if (named != modes.end()) {
        return &*named;
    }
    const auto numbered = std::ranges::find_if(modes, [&](const ScanMode& mode) {
        return mode.id && std::to_string(*mode.id) == name;
    });
    return numbered == modes.end() ? nullptr : &*numbered;
}

const ScanMode* best_mode(const std::vector<ScanMode>& modes) {
    const auto typical = std::ranges::find_if(modes, &ScanMode::typical);
    if (typical != modes.end()) {
        return &*typical;
    }
    const auto fastest = std::ranges::max_element(modes, {}, &ScanMode::samples_per_second);
    return fastest == modes.end() ? nullptr : &*fastest;
}

}  // namespace sweepcast::device
