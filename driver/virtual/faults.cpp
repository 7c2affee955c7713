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

// The value of a fault as users write it, empty for one that has none; none if it is not there.
using Show = std::optional<std::string> (*)(const Faults&);

// What can be done with a fault.
struct Ways {
    Set set;
    void (*clear)(Faults&);
    Show show;
};

struct Fault {
    std::string_view name;
    std::string_view value;  ///< what may follow the name, as help texts show it
    std::string_view what;
    Ways ways;
};

// The whole of `text` as a number in this range.
template <class Number>
bool parse_number(std::string_view text, Number least, Number most, Number& number) {
    const auto* const end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(text.data(), end, number);
    // Written so that NaN is refused.
    return failure == std::errc{} && stop == end && number >= least && number <= most;
}

template <auto Member>
void reset(Faults& faults) {
    faults.*Member = {};
}

template <bool Faults::*Member>
bool set_flag(Faults& faults, std::optional<std::string_view> value) {
    faults.*Member = true;
    return !value;
}

template <bool Faults::*Member>
std::optional<std::string> show_flag(const Faults& faults) {
    return faults.*Member ? std::optional<std::string>("") : std::nullopt;
}

template <bool Faults::*Member>
constexpr Ways flag{set_flag<Member>, reset<Member>, show_flag<Member>};

template <double Faults::*Member>
bool set_rate(Faults& faults, std::optional<std::string_view> value) {
    return value && parse_number(*value, 0.0, 1.0, faults.*Member);
}

template <double Faults::*Member>
std::optional<std::string> show_rate(const Faults& faults) {
    return faults.*Member > 0.0 ? std::optional(fmt::format("{}", faults.*Member)) : std::nullopt;
}

template <double Faults::*Member>
constexpr Ways rate{set_rate<Member>, reset<Member>, show_rate<Member>};

template <std::chrono::milliseconds Faults::*Member, int UsualMs, int MostMs>
bool set_ms(Faults& faults, std::optional<std::string_view> value) {
    int given_ms = UsualMs;
    if (value && !parse_number(*value, 1, MostMs, given_ms)) {
        return false;
    }
    faults.*Member = std::chrono::milliseconds(given_ms);
    return true;
}

template <std::chrono::milliseconds Faults::*Member>
std::optional<std::string> show_ms(const Faults& faults) {
    return (faults.*Member).count() > 0 ? std::optional(std::to_string((faults.*Member).count()))
                                        : std::nullopt;
}

template <std::chrono::milliseconds Faults::*Member, int UsualMs, int MostMs>
constexpr Ways in_ms{set_ms<Member, UsualMs, MostMs>, reset<Member>, show_ms<Member>};

template <std::chrono::milliseconds Faults::*Member, int UsualS>
bool set_seconds(Faults& faults, std::optional<std::string_view> value) {
    constexpr double least_s = 0.001;
    constexpr double most_s = 86'400.0;
    double given_s = UsualS;
    if (value ? !parse_number(*value, least_s, most_s, given_s) : UsualS == 0) {
        return false;
    }
    faults.*Member =
        std::chrono::round<std::chrono::milliseconds>(std::chrono::duration<double>(given_s));
    return true;
}

template <std::chrono::milliseconds Faults::*Member>
std::optional<std::string> show_seconds(const Faults& faults) {
    const std::chrono::duration<double> seconds = faults.*Member;
    return seconds.count() > 0.0 ? std::optional(fmt::format("{}", seconds.count())) : std::nullopt;
}

// Without a usual value (0) one has to be given.
template <std::chrono::milliseconds Faults::*Member, int UsualS>
constexpr Ways in_seconds{set_seconds<Member, UsualS>, reset<Member>, show_seconds<Member>};

bool set_baud(Faults& faults, std::optional<std::string_view> value) {
    constexpr std::uint32_t usual = 57'600;  // no scanner's
    constexpr std::uint32_t slowest = 9'600;
    constexpr std::uint32_t fastest = 1'000'000;
    faults.wrong_baud = usual;
    return !value || parse_number(*value, slowest, fastest, faults.wrong_baud);
}

std::optional<std::string> show_baud(const Faults& faults) {
    return faults.wrong_baud != 0 ? std::optional(std::to_string(faults.wrong_baud)) : std::nullopt;
}

bool set_length(Faults& faults, std::optional<std::string_view> value) {
    constexpr std::uint32_t most = (1U << 30U) - 1U;  // what a descriptor can say
    std::uint32_t given = most;
    if (value && !parse_number(*value, 0U, most, given)) {
        return false;
    }
    faults.lying_length = given;
    return true;
}

std::optional<std::string> show_length(const Faults& faults) {
    return faults.lying_length ? std::optional(std::to_string(*faults.lying_length)) : std::nullopt;
}

template <HealthStatus Status>
bool set_health(Faults& faults, std::optional<std::string_view> value) {
    faults.health = {Status, usual_health_code};
    if (!value) {
        return true;
    }
    const auto code = parse_health_code(*value);
    faults.health.code = code.value_or(0);
    return code.has_value();
}

template <HealthStatus Status>
void clear_health(Faults& faults) {
    if (faults.health.status == Status) {
        faults.health = {};
    }
}

template <HealthStatus Status>
std::optional<std::string> show_health(const Faults& faults) {
    return faults.health.status == Status ? std::optional(fmt::format("{:#x}", faults.health.code))
                                          : std::nullopt;
}

template <HealthStatus Status>
constexpr Ways health{set_health<Status>, clear_health<Status>, show_health<Status>};

constexpr int usual_burst_ms = 16;
constexpr int most_burst_ms = 1'000;
constexpr int usual_delay_ms = 200;
constexpr int most_delay_ms = 5'000;
constexpr int usual_spin_up_s = 10;

constexpr std::array all_faults{
    Fault{"mute", "", "never says anything", flag<&Faults::mute>},
    Fault{"deaf", "", "hears no request; a scan that runs goes on", flag<&Faults::deaf>},
    Fault{
        "banner",
        "",
        "prints its boot text again and again, answers nothing",
        flag<&Faults::banner>},
    Fault{
        "protection-stop",
        "[=CODE]",
        "health is error, also after RESET; does not scan",
        health<HealthStatus::error>},
    Fault{
        "protection-stop-after",
        "=S",
        "each scan ends in a protection stop after this time",
        in_seconds<&Faults::protection_stop_after, 0>},
    Fault{
        "warning",
        "[=CODE]",
        "health is warning, also after RESET",
        health<HealthStatus::warning>},
    Fault{
        "motor-stall",
        "",
        "takes scan requests, but the motor does not turn",
        flag<&Faults::motor_stall>},
    Fault{
        "forced",
        "",
        "measures also while its motor is not up to speed, or stands",
        flag<&Faults::forced>},
    Fault{
        "slow-spin-up",
        "[=S]",
        "the motor takes this time (10 s) to come up to speed",
        in_seconds<&Faults::slow_spin_up, usual_spin_up_s>},
    Fault{"noise", "=RATE", "this part of the bytes it sends is changed", rate<&Faults::noise>},
    Fault{"drop", "=RATE", "this part of the bytes it sends is lost", rate<&Faults::drop>},
    Fault{
        "duplicate",
        "=RATE",
        "this part of the bytes it sends arrives twice",
        rate<&Faults::duplicate>},
    Fault{"garbage", "", "every measurement byte it sends is changed", flag<&Faults::garbage>},
    Fault{
        "burst",
        "[=MS]",
        "what it sends arrives every 16 ms only, as behind some USB adapters",
        in_ms<&Faults::burst, usual_burst_ms, most_burst_ms>},
    Fault{
        "delay",
        "[=MS]",
        "what it sends arrives this much (200 ms) later",
        in_ms<&Faults::delay, usual_delay_ms, most_delay_ms>},
    Fault{
        "flood",
        "",
        "sends its last packet again and again, as fast as the port takes it",
        flag<&Faults::flood>},
    Fault{
        "wrong-baud",
        "[=BAUD]",
        "its line has another speed (57600) than the model's",
        {set_baud, reset<&Faults::wrong_baud>, show_baud}},
    Fault{
        "lying-length",
        "[=BYTES]",
        "descriptors tell this length (2^30-1), whatever follows",
        {set_length, reset<&Faults::lying_length>, show_length}},
    Fault{
        "half-answers",
        "",
        "of every answer it sends the first half only",
        flag<&Faults::half_answers>},
    Fault{"sample-time-zero", "", "says that a sample takes 0 us", flag<&Faults::sample_time_zero>},
    Fault{
        "bare-echo",
        "",
        "answers configuration queries without a value",
        flag<&Faults::bare_echo>},
    Fault{"junk", "", "noise before every descriptor", flag<&Faults::junk>},
    Fault{
        "leftovers",
        "",
        "is scanning when opened, as after a crash of its host",
        flag<&Faults::leftovers>},
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
            "a RATE is 0 to 1, e.g. 0.01; MS is 1 to 1000 (delay: 5000); S is seconds, 0.001 to "
            "86400; BAUD is 9600 to 1000000; BYTES is 0 to 1073741823; a CODE is 0 to 65535, or "
            "hex such as 0x8001"};
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
    if (!fault->ways.set(changed, value)) {
        return not_a_fault(text, fault);
    }
    faults = changed;
    return {};
}

Result<void, Problem> clear_fault(Faults& faults, std::string_view name) {
    const auto* const fault = std::ranges::find(all_faults, name, &Fault::name);
    if (fault == all_faults.end()) {
        return not_a_fault(name, nullptr);
    }
    fault->ways.clear(faults);
    return {};
}

std::string faults_text(const Faults& faults) {
    std::string text;
    for (const auto& fault : all_faults) {
        if (const auto value = fault.ways.show(faults)) {
            text += text.empty() ? "" : ",";
            text += fault.name;
            text += value->empty() ? "" : "=" + *value;
        }
    }
    return text;
}

std::optional<std::uint16_t> parse_health_code(std::string_view text) {
    const bool hex = text.starts_with("0x");
    const auto digits = text.substr(hex ? 2 : 0);
    const auto* const end = digits.data() + digits.size();
    std::uint16_t code{};
    const auto [stop, failure] = std::from_chars(digits.data(), end, code, hex ? 16 : 10);
    return failure == std::errc{} && stop == end ? std::optional(code) : std::nullopt;
}

std::span<const std::uint8_t> junk_before_descriptor() {
    static constexpr std::array<std::uint8_t, 6> junk{0x00, 0x37, 0xA5, 0x11, 0xFF, 0xA5};
    return junk;
}

}  // namespace sweepcast::virtual_lidar
