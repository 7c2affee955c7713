// Wishes as the parameters of a URL.
#include "server/stream/subscribe_wish.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <set>

namespace sweepcast::stream {

namespace {

using v1::Subscribe;

/// Reads all of `text` as a number.
bool read(std::string_view text, double& value) {
    const auto* end = text.data() + text.size();
    const auto [rest, failed] = std::from_chars(text.data(), end, value, std::chars_format::fixed);
    return failed == std::errc{} && rest == end;
}

bool read(std::string_view text, std::uint32_t& value) {
    const auto* end = text.data() + text.size();
    const auto [rest, failed] = std::from_chars(text.data(), end, value);
    return failed == std::errc{} && rest == end;
}

template <class T, void (Subscribe::*Set)(T)>
bool number(std::string_view text, Subscribe& subscribe) {
    T value{};
    const bool is_number = read(text, value);
    (subscribe.*Set)(value);
    return is_number;
}

/// Reads each part of a list with commas.
template <bool (*ReadPart)(std::string_view, Subscribe&)>
bool list(std::string_view text, Subscribe& subscribe) {
    for (;;) {
        const auto comma = text.find(',');
        if (!ReadPart(text.substr(0, comma), subscribe)) {
            return false;
        }
        if (comma == std::string_view::npos) {
            return true;
        }
        text.remove_prefix(comma + 1);
    }
}

template <v1::AngleWindow* (Subscribe::*Add)()>
bool window(std::string_view text, Subscribe& subscribe) {
    const auto dash = text.find('-');
    if (dash == std::string_view::npos) {
        return false;
    }
    double from = 0;
    double to = 0;
    const bool are_numbers = read(text.substr(0, dash), from) && read(text.substr(dash + 1), to);
    auto& added = *(subscribe.*Add)();
    added.set_from_deg(from);
    added.set_to_deg(to);
    return are_numbers;
}

bool lidar(std::string_view text, Subscribe& subscribe) {
    subscribe.set_lidar(std::string(text));
    return true;
}

bool kind(std::string_view text, Subscribe& subscribe) {
    subscribe.set_kind(text == "sector" ? v1::SECTOR : v1::SWEEP);
    return text == "sector" || text == "sweep";
}

bool compression(std::string_view text, Subscribe& subscribe) {
    subscribe.set_compression(text == "none" ? v1::NONE : v1::ZSTD);
    return text == "none" || text == "zstd";
}

bool column(std::string_view text, Subscribe& subscribe) {
    constexpr std::array<std::pair<std::string_view, v1::Column>, 3> columns{{
        {"quality", v1::QUALITY},
        {"flag", v1::FLAG},
        {"time", v1::TIME},
    }};
    for (const auto& [name, value] : columns) {
        if (name == text) {
            subscribe.add_leave_out(value);
            return true;
        }
    }
    return false;
}

bool dictionary(std::string_view text, Subscribe& subscribe) {
    std::uint32_t id = 0;
    const bool is_number = read(text, id);
    subscribe.add_dictionaries(id);
    return is_number;
}

bool bins(std::string_view text, Subscribe& subscribe) {
    std::uint32_t count = 0;
    const bool is_number = read(text, count);
    subscribe.mutable_bins()->set_count(count);
    return is_number;
}

bool bins_pick(std::string_view text, Subscribe& subscribe) {
    subscribe.mutable_bins()->set_pick(text == "minimum" ? v1::Bins::MINIMUM : v1::Bins::NEAREST);
    return text == "minimum" || text == "nearest";
}

struct Parameter {
    std::string_view name;
    bool (*read)(std::string_view, Subscribe&);
    std::string_view expected;
    bool is_list{};
    std::string_view code{"bad_value"};
};

constexpr std::array<Parameter, 18> parameters{{
    {"lidar", lidar, "an id"},
    {"kind", kind, "sweep or sector", false, "unknown_kind"},
    {"compression", compression, "zstd or none", false, "unknown_compression"},
    {"dictionaries", list<dictionary>, "ids, with commas between them", true},
    {"sector_deg", number<double, &Subscribe::set_sector_deg>, "degrees"},
    {"max_latency_ms", number<double, &Subscribe::set_max_latency_ms>, "milliseconds"},
    {"max_rate_hz", number<double, &Subscribe::set_max_rate_hz>, "sweeps a second"},
    {"keep", list<window<&Subscribe::add_keep>>, "FROM-TO in degrees, e.g. 350-10", true},
    {"mask", list<window<&Subscribe::add_mask>>, "FROM-TO in degrees, e.g. 350-10", true},
    {"min_distance_mm", number<double, &Subscribe::set_min_distance_mm>, "millimetres"},
    {"max_distance_mm", number<double, &Subscribe::set_max_distance_mm>, "millimetres"},
    {"min_quality", number<std::uint32_t, &Subscribe::set_min_quality>, "0 to 255"},
    {"every_nth", number<std::uint32_t, &Subscribe::set_every_nth>, "a whole number"},
    {"bins", bins, "1 to 16384"},
    {"bins_pick", bins_pick, "nearest or minimum"},
    {"leave_out",
     list<column>,
     "quality, flag, time, with commas between them",
     true,
     "unknown_column"},
    {"distance_unit_um", number<std::uint32_t, &Subscribe::set_distance_unit_um>, "micrometres"},
    {"angle_units_per_turn",
     number<std::uint32_t, &Subscribe::set_angle_units_per_turn>,
     "a whole number"},
}};

std::string names() {
    std::string names;
    for (const auto& parameter : parameters) {
        names += (names.empty() ? "" : ", ") + std::string(parameter.name);
    }
    return names;
}

}  // namespace

Result<v1::Subscribe, Refusal> subscribe_from_query(const Query& query) {
    Subscribe subscribe;
    std::set<std::string_view> seen;
    for (const auto& [key, value] : query) {
        const auto parameter = std::ranges::find(parameters, key, &Parameter::name);
        if (parameter == parameters.end()) {
            return Refusal{
                "unknown_parameter",
                fmt::format("no parameter \"{}\"", key),
                "parameters: " + names()};
        }
        if (!seen.insert(parameter->name).second && !parameter->is_list) {
            return Refusal{
                "repeated_parameter",
                fmt::format("the parameter \"{}\" is given twice", key),
                "give it once"};
        }
        if (!parameter->read(value, subscribe)) {
            return Refusal{
                std::string(parameter->code),
                fmt::format("{} cannot be \"{}\"", key, value),
                fmt::format("{}: {}", key, parameter->expected)};
        }
    }
    return subscribe;
}

}  // namespace sweepcast::stream
