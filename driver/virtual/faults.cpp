#include "driver/virtual/faults.hpp"

#include "driver/virtual/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <system_error>

namespace sweepcast::virtual_lidar {

namespace {

using protocol::HealthStatus;

// Sets a fault to what the text after "=" says (none: there was no "="). False if that makes no
// sense.
using Set = bool (*)(Faults&, std::optional<std::string_view>);

struct Fault {
    std::string_view name;
    std::string_view value;  ///< what may follow the name, as help texts show it
    std::string_view what;
    Set set;
};

template <bool Faults::*Member>
bool set_flag(Faults& faults, std::optional<std::string_view> value) {
    faults.*Member = true;
    return !value;
}

template <double Faults::*Member>
bool set_rate(Faults& faults, std::optional<std::string_view> value) {
    if (!value) {
        return false;
    }
    const auto* const end = value->data() + value->size();
    const auto [stop, failure] = std::from_chars(value->data(), end, faults.*Member);
    // Written so that NaN is refused.
    return failure == std::errc{} && stop == end && faults.*Member >= 0.0 && faults.*Member <= 1.0;
}

bool set_burst(Faults& faults, std::optional<std::string_view> value) {
    constexpr int usual_ms = 16;
    constexpr int most_ms = 1000;
    int given_ms = usual_ms;
    if (value) {
        const auto* const end = value->data() + value->size();
        const auto [stop, failure] = std::from_chars(value->data(), end, given_ms);
        if (failure != std::errc{} || stop != end || given_ms < 1 || given_ms > most_ms) {
            return false;
        }
    }
    faults.burst = std::chrono::milliseconds(given_ms);
    return true;
}

template <HealthStatus Status>
bool set_health(Faults& faults, std::optional<std::string_view> value) {
    constexpr std::uint16_t usual_code = 1;
    faults.health = {Status, usual_code};
    if (!value) {
        return true;
    }
    const bool hex = value->starts_with("0x");
    const auto digits = value->substr(hex ? 2 : 0);
    const auto* const end = digits.data() + digits.size();
    const auto [stop, failure] =
        std::from_chars(digits.data(), end, faults.health.code, hex ? 16 : 10);
    return failure == std::errc{} && stop == end;
}

constexpr std::array all_faults{
    Fault{"mute", "", "never says anything", set_flag<&Faults::mute>},
    Fault{
        "banner",
        "",
        "prints its boot text again and again, answers nothing",
        set_flag<&Faults::banner>},
    Fault{
        "protection-stop",
        "[=CODE]",
        "health is error, also after RESET; does not scan",
        set_health<HealthStatus::error>},
    Fault{
        "warning",
        "[=CODE]",
        "health is warning, also after RESET",
        set_health<HealthStatus::warning>},
    Fault{
        "motor-stall",
        "",
        "takes scan requests, but the motor never turns",
        set_flag<&Faults::motor_stall>},
    Fault{"noise", "=RATE", "this part of the bytes it sends is changed", set_rate<&Faults::noise>},
    Fault{"drop", "=RATE", "this part of the bytes it sends is lost", set_rate<&Faults::drop>},
    Fault{
        "burst",
        "[=MS]",
        "what it sends arrives every 16 ms only, as behind some USB adapters",
        set_burst},
    Fault{
        "sample-time-zero",
        "",
        "says that a sample takes 0 us",
        set_flag<&Faults::sample_time_zero>},
    Fault{
        "bare-echo",
        "",
        "answers configuration queries without a value",
        set_flag<&Faults::bare_echo>},
    Fault{"junk", "", "noise before every descriptor", set_flag<&Faults::junk>},
    Fault{
        "leftovers",
        "",
        "is scanning when opened, as after a crash of its host",
        set_flag<&Faults::leftovers>},
};

Problem not_a_fault(std::string_view text, const Fault* fault) {
    if (fault != nullptr) {
        return {
            errc::invalid_option,
            fmt::format(
                "the fault \"{}\" is not of the form {}{}",
                text,
                fault->name,
                fault->value
            ),
            "a RATE is 0 to 1, e.g. 0.01; MS is 1 to 1000; a CODE is 0 to 65535, or hex such as "
            "0x8001"};
    }
    std::string known;
    for (const auto& each : all_faults) {
        known += fmt::format("{}{}{}", known.empty() ? "" : ", ", each.name, each.value);
    }
    return {
        errc::invalid_option,
        fmt::format("there is no fault \"{}\"", text),
        "known faults: " + known};
}

}  // namespace

std::string faults_help() {
    std::string help;
    for (const auto& fault : all_faults) {
        help +=
            fmt::format("  {:<24} {}\n", fmt::format("{}{}", fault.name, fault.value), fault.what);
    }
    return help;
}

Result<void, Problem> add_fault(Faults& faults, std::string_view text) {
    const auto equals = text.find('=');
    const auto name = text.substr(0, equals);
    const auto value =
        equals == std::string_view::npos ? std::nullopt : std::optional(text.substr(equals + 1));
    const auto* const fault = std::ranges::find(all_faults, name, &Fault::name);
    if (fault == all_faults.end()) {
        return not_a_fault(text, nullptr);
    }
    Faults changed = faults;
    if (!fault->set(changed, value)) {
        return not_a_fault(text, fault);
    }
    faults = changed;
    return {};
}

BadLine::BadLine(double noise, double drop, std::uint64_t seed)
    : noise_(noise)
    , drop_(drop)
    , random_(seed) {}

void BadLine::damage(std::vector<std::uint8_t>& bytes) {
    if (is_good()) {
        return;
    }
    const auto is_lost = [this](std::uint8_t) { return random_.uniform() < drop_; };
    bytes.erase(std::remove_if(bytes.begin(), bytes.end(), is_lost), bytes.end());
    for (auto& byte : bytes) {
        if (random_.uniform() < noise_) {
            byte = static_cast<std::uint8_t>(byte ^ (1U + random_.next() % 255U));
        }
    }
}

std::span<const std::uint8_t> junk_before_descriptor() {
    static constexpr std::array<std::uint8_t, 6> junk{0x00, 0x37, 0xA5, 0x11, 0xFF, 0xA5};
    return junk;
}

}  // namespace sweepcast::virtual_lidar
