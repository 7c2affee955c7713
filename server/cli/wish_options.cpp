#include "server/cli/wish_options.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <charconv>
#include <map>
#include <string_view>

namespace sweepcast::cli {

namespace {

constexpr const char* group = "What to get";

std::optional<double> parse_degrees(std::string_view text) {
    double degrees{};
    const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), degrees);
    const bool is_number = failed == std::errc() && end == text.data() + text.size();
    // Written so that NaN fails.
    return is_number && degrees >= 0 && degrees <= 360 ? std::optional(degrees) : std::nullopt;
}

/// An option with a number that goes to a setter of the wish.
template <class Value>
void add_number(
    CLI::App& command,
    const char* name,
    const char* unit,
    const char* help,
    CLI::Range range,
    v1::Subscribe& wish,
    void (v1::Subscribe::*set)(Value)
) {
    const std::function<void(const Value&)> take = [&wish, set](const Value& value) {
        (wish.*set)(value);
    };
    command.add_option_function<Value>(name, take, help)
        ->check(range.description(""))
        ->type_name(unit)
        ->group(group);
}

/// An option that may be given again and again.
void add_windows(
    CLI::App& command,
    const char* name,
    const char* help,
    google::protobuf::RepeatedPtrField<v1::AngleWindow>& windows
) {
    const std::function<void(const std::vector<std::string>&)> take =
        [&windows, name](const std::vector<std::string>& texts) {
            for (const auto& text : texts) {
                const auto window = parse_angle_window(text);
                if (!window) {
                    throw CLI::ValidationError(
                        name,
                        "\"" + text +
                            "\" is no window: write FROM-TO in degrees, such as 90-270, or 350-10"
                    );
                }
                windows.Add()->CopyFrom(*window);
            }
        };
    command.add_option_function(name, take, help)->type_name("FROM-TO")->group(group);
}

/// An option with one of some words.
void add_word(
    CLI::App& command,
    const char* name,
    const char* help,
    std::map<std::string, int> words,
    std::function<void(int)> set
) {
    const std::function<void(const std::string&)> take =
        [words, set = std::move(set)](const std::string& word) { set(words.at(word)); };
    command.add_option_function(name, take, help)->check(CLI::IsMember(words))->group(group);
}

void add_forms(CLI::App& command, v1::Subscribe& wish) {
    const std::function<void(const std::string&)> take_lidar = [&wish](const std::string& id) {
        wish.set_lidar(id);
    };
    command.add_option_function("--lidar", take_lidar, "Id of the lidar; without it all")
        ->group(group);
    add_word(
        command,
        "--compression",
        "zstd (the usual) or none",
        {{"zstd", v1::ZSTD}, {"none", v1::NONE}},
        [&wish](int value) { wish.set_compression(static_cast<v1::Compression>(value)); }
    );
    add_word(
        command,
        "--kind",
        "sweep (the usual), or sector: slices of one, as soon as they have been measured",
        {{"sweep", v1::SWEEP}, {"sector", v1::SECTOR}},
        [&wish](int value) { wish.set_kind(static_cast<v1::Kind>(value)); }
    );
    const CLI::Range any(0.0, 1e9);
    add_number(
        command,
        "--sector-deg",
        "DEG",
        "Sectors of so many degrees",
        any,
        wish,
        &v1::Subscribe::set_sector_deg
    );
    add_number(
        command,
        "--max-latency",
        "MS",
        "Sectors: no sample waits longer than so many milliseconds",
        any,
        wish,
        &v1::Subscribe::set_max_latency_ms
    );
    add_number(
        command,
        "--max-rate",
        "HZ",
        "No more than so many sweeps a second",
        any,
        wish,
        &v1::Subscribe::set_max_rate_hz
    );
}

void add_filters(CLI::App& command, v1::Subscribe& wish) {
    add_windows(
        command,
        "--keep",
        "Only samples at these angles; may be repeated",
        *wish.mutable_keep()
    );
    add_windows(
        command,
        "--mask",
        "No samples at these angles; may be repeated",
        *wish.mutable_mask()
    );
    const CLI::Range millimetres(0.0, 1e6);
    add_number(
        command,
        "--min-distance",
        "MM",
        "Nearer echoes count as none",
        millimetres,
        wish,
        &v1::Subscribe::set_min_distance_mm
    );
    add_number(
        command,
        "--max-distance",
        "MM",
        "Farther echoes count as none",
        millimetres,
        wish,
        &v1::Subscribe::set_max_distance_mm
    );
    add_number(
        command,
        "--min-quality",
        "N",
        "Weaker echoes count as none (0 to 255)",
        CLI::Range(0, 255),
        wish,
        &v1::Subscribe::set_min_quality
    );
    const CLI::Range count(1, 65536);
    add_number(
        command,
        "--every",
        "N",
        "Only every so-manieth sample",
        count,
        wish,
        &v1::Subscribe::set_every_nth
    );
    const std::function<void(const std::uint32_t&)> take_bins = [&wish](const std::uint32_t& bins) {
        wish.mutable_bins()->set_count(bins);
    };
    auto* bins = command.add_option_function(
        "--bins",
        take_bins,
        "Always so many samples, at the same angles: one for each part of the circle"
    );
    bins->check(CLI::Range(1, 16384).description(""))->type_name("N")->group(group);
    command
        .add_flag_callback(
            "--bins-minimum",
            [&wish] { wish.mutable_bins()->set_pick(v1::Bins::MINIMUM); },
            "The nearest echo of each part, not the sample nearest to its middle"
        )
        ->needs(bins)
        ->group(group);
}

}  // namespace

void add_wish_options(CLI::App& command, v1::Subscribe& wish) {
    add_forms(command, wish);
    add_filters(command, wish);
}

std::optional<std::string> given_wish_option(const CLI::App& command) {
    for (const auto* option : command.get_options()) {
        if (option->get_group() == group && option->count() > 0) {
            return option->get_name();
        }
    }
    return std::nullopt;
}

std::optional<v1::AngleWindow> parse_angle_window(const std::string& text) {
    const auto dash = text.find('-');
    if (dash == std::string::npos) {
        return std::nullopt;
    }
    const auto from = parse_degrees(std::string_view(text).substr(0, dash));
    const auto to = parse_degrees(std::string_view(text).substr(dash + 1));
    if (!from || !to) {
        return std::nullopt;
    }
    v1::AngleWindow window;
    window.set_from_deg(*from);
    window.set_to_deg(*to);
    return window;
}

}  // namespace sweepcast::cli
