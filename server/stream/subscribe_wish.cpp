#include "server/stream/subscribe_wish.hpp"

#include "driver/protocol/sweep_assembler.hpp"
#include "server/frame/dictionary.hpp"
#include "server/frame/distance_units.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace sweepcast::stream {

namespace {

using Checked = std::optional<Refusal>;  ///< none: fine

constexpr double usual_sector_deg = frame::usual_sector_mdeg / 1000.0;
constexpr double longest_latency_ms = 60'000;
constexpr double slowest_rate_hz = 0.001;
constexpr double fastest_rate_hz = 1000;
constexpr double farthest_mm = 1'000'000;
constexpr std::uint32_t largest_quality = 255;
constexpr std::uint32_t most_bins = 16384;
constexpr std::uint32_t fewest_angle_units = 360;
constexpr std::uint32_t most_angle_units = 65536;
constexpr int most_windows = 16;
constexpr int most_dictionaries = 64;

Checked out_of_range(std::string_view field, double value, std::string_view range) {
    return Refusal{
        "out_of_range",
        fmt::format("{} cannot be {}", field, value),
        fmt::format("{}: {}", field, range)};
}

Checked contradiction(std::string_view message, std::string_view hint) {
    return Refusal{"contradiction", std::string(message), std::string(hint)};
}

/// A field whose value 0 stands for "not wished".
struct Field {
    std::string_view name;
    double value;
    double least;
    double most;
    std::string_view range;
};

Checked check(const Field& field) {
    // Written so that NaN is refused.
    const bool is_fine =
        field.value == 0 || (field.value >= field.least && field.value <= field.most);
    return is_fine ? std::nullopt : out_of_range(field.name, field.value, field.range);
}

Checked check_values(const v1::Subscribe& wish) {
    const std::array<Field, 9> fields{{
        {"sector_deg",
         wish.sector_deg(),
         std::numeric_limits<double>::min(),
         360,
         "more than 0 up to 360 degrees"},
        {"max_latency_ms",
         wish.max_latency_ms(),
         std::numeric_limits<double>::min(),
         longest_latency_ms,
         "more than 0 up to 60000 milliseconds"},
        {"max_rate_hz",
         wish.max_rate_hz(),
         slowest_rate_hz,
         fastest_rate_hz,
         "0.001 to 1000 a second; 0: every sweep"},
        {"min_distance_mm", wish.min_distance_mm(), 0, farthest_mm, "0 to 1000000 millimetres"},
        {"max_distance_mm",
         wish.max_distance_mm(),
         0,
         farthest_mm,
         "0 to 1000000 millimetres; 0: no limit"},
        {"min_quality", static_cast<double>(wish.min_quality()), 0, largest_quality, "0 to 255"},
        {"every_nth",
         static_cast<double>(wish.every_nth()),
         0,
         protocol::max_sweep_samples,
         "1 to 16384"},
        {"distance_unit_um",
         static_cast<double>(wish.distance_unit_um()),
         0,
         frame::coarsest_um,
         "1 to 1000000 micrometres; 0: as measured"},
        {"angle_units_per_turn",
         static_cast<double>(wish.angle_units_per_turn()),
         fewest_angle_units,
         most_angle_units,
         "360 to 65536; 0: as measured"},
    }};
    for (const auto& field : fields) {
        if (auto refused = check(field)) {
            return refused;
        }
    }
    const auto bins = wish.bins().count();
    if (wish.has_bins() && (bins == 0 || bins > most_bins)) {
        return out_of_range("bins", bins, "1 to 16384");
    }
    if (wish.bins().pick() != v1::Bins::NEAREST && wish.bins().pick() != v1::Bins::MINIMUM) {
        return out_of_range("bins_pick", wish.bins().pick(), "NEAREST (0) or MINIMUM (1)");
    }
    return std::nullopt;
}

Checked check_windows(
    std::string_view name,
    const google::protobuf::RepeatedPtrField<v1::AngleWindow>& windows
) {
    if (windows.size() > most_windows) {
        return Refusal{
            "too_many_windows",
            fmt::format("{} windows in {}", windows.size(), name),
            fmt::format("at most {} each in keep and mask", most_windows)};
    }
    for (const auto& window : windows) {
        for (const double end : {window.from_deg(), window.to_deg()}) {
            if (!(end >= 0 && end <= 360)) {
                return out_of_range(name, end, "0 to 360 degrees; may go over 0: from 350 to 10");
            }
        }
        const bool is_circle = window.from_deg() == 0 && window.to_deg() == 360;
        if (!is_circle && std::fmod(window.from_deg(), 360) == std::fmod(window.to_deg(), 360)) {
            return Refusal{
                "empty_window",
                fmt::format("{} has a window from {} to itself", name, window.from_deg()),
                "a window's end is not in it; the whole circle is from 0 to 360"};
        }
    }
    return std::nullopt;
}

Checked check_combination(const v1::Subscribe& wish) {
    const bool has_sector_size = wish.sector_deg() != 0 || wish.max_latency_ms() != 0;
    if (wish.kind() == v1::SWEEP && has_sector_size) {
        return contradiction(
            "sweeps have no sector_deg and no max_latency_ms",
            "wish for the kind SECTOR (in a URL: kind=sector)"
        );
    }
    if (wish.kind() == v1::SECTOR && wish.has_bins()) {
        return contradiction("bins are of whole sweeps", "wish for the kind SWEEP, or for no bins");
    }
    if (wish.kind() == v1::SECTOR && wish.max_rate_hz() != 0) {
        return contradiction(
            "max_rate_hz is of whole sweeps",
            "wish for the kind SWEEP, or leave max_rate_hz out"
        );
    }
    if (wish.has_bins() && wish.angle_units_per_turn() != 0) {
        return contradiction(
            "bins have angles of their own",
            "leave angle_units_per_turn out: it is twice the number of bins"
        );
    }
    if (wish.max_distance_mm() != 0 && wish.min_distance_mm() > wish.max_distance_mm()) {
        return contradiction(
            fmt::format(
                "nothing is at least {} and at most {} mm away",
                wish.min_distance_mm(),
                wish.max_distance_mm()
            ),
            "min_distance_mm is the smaller one"
        );
    }
    return std::nullopt;
}

Checked check_names(const v1::Subscribe& wish) {
    if (wish.kind() != v1::SWEEP && wish.kind() != v1::SECTOR) {
        return Refusal{
            "unknown_kind",
            fmt::format("no kind {}", wish.kind()),
            "kinds: SWEEP, SECTOR"};
    }
    if (wish.compression() != v1::ZSTD && wish.compression() != v1::NONE) {
        return Refusal{
            "unknown_compression",
            fmt::format("no compression {}", wish.compression()),
            "compressions: ZSTD, NONE"};
    }
    for (const int column : wish.leave_out()) {
        if (column != v1::QUALITY && column != v1::FLAG && column != v1::TIME) {
            return Refusal{
                "unknown_column",
                fmt::format("no column {} that could be left out", column),
                "columns: QUALITY, FLAG, TIME"};
        }
    }
    if (wish.dictionaries_size() > most_dictionaries) {
        return Refusal{
            "too_many_dictionaries",
            fmt::format("{} dictionaries", wish.dictionaries_size()),
            fmt::format("at most {}; Hello lists those that are used", most_dictionaries)};
    }
    return std::nullopt;
}

Checked check_all(const v1::Subscribe& wish) {
    for (auto& refused :
         {check_names(wish),
          check_values(wish),
          check_windows("keep", wish.keep()),
          check_windows("mask", wish.mask()),
          check_combination(wish)}) {
        if (refused) {
            return refused;
        }
    }
    return std::nullopt;
}

/// Fills in the defaults, and leaves out what has no effect.
void understand(v1::Subscribe& wish) {
    if (wish.kind() == v1::SECTOR && wish.sector_deg() == 0 && wish.max_latency_ms() == 0) {
        wish.set_sector_deg(usual_sector_deg);
    }
    const auto& theirs = wish.dictionaries();
    const auto ours = frame::dictionary_id();
    const bool has_ours = std::find(theirs.begin(), theirs.end(), ours) != theirs.end();
    wish.clear_dictionaries();
    if (has_ours && wish.compression() == v1::ZSTD) {
        wish.add_dictionaries(ours);
    }
}

frame::FrameFormat format(const v1::Subscribe& wish) {
    frame::FrameFormat format;
    format.compression =
        wish.compression() == v1::ZSTD ? frame::Compression::zstd : frame::Compression::none;
    format.dictionary = wish.dictionaries_size() > 0;
    format.angle_units_per_turn =
        wish.has_bins() ? 2 * wish.bins().count() : wish.angle_units_per_turn();
    format.distance_unit_um = wish.distance_unit_um();
    for (const int column : wish.leave_out()) {
        format.leave_out_quality |= column == v1::QUALITY;
        format.leave_out_flags |= column == v1::FLAG;
        format.leave_out_times |= column == v1::TIME;
    }
    return format;
}

std::vector<frame::AngleWindow> windows(
    const google::protobuf::RepeatedPtrField<v1::AngleWindow>& from
) {
    std::vector<frame::AngleWindow> windows;
    for (const auto& window : from) {
        windows.push_back({window.from_deg(), window.to_deg()});
    }
    return windows;
}

/// In whole units, but never 0, which would be no wish at all.
template <class T>
T at_least_one(double value) {
    return static_cast<T>(std::max<std::int64_t>(std::llround(value), 1));
}

void set_pace(const v1::Subscribe& from, frame::Wish& wish) {
    if (from.sector_deg() > 0) {
        wish.sector_mdeg = at_least_one<std::uint32_t>(from.sector_deg() * 1000);
    }
    if (from.max_latency_ms() > 0) {
        wish.max_latency =
            std::chrono::microseconds(at_least_one<std::int64_t>(from.max_latency_ms() * 1000));
    }
    if (from.max_rate_hz() > 0) {
        wish.least_interval =
            std::chrono::microseconds(at_least_one<std::int64_t>(1e6 / from.max_rate_hz()));
    }
}

void set_range(const v1::Subscribe& from, frame::Wish& wish) {
    wish.nearest.raw = static_cast<std::uint32_t>(std::ceil(from.min_distance_mm() * 4));
    if (from.max_distance_mm() > 0) {
        wish.farthest.raw = static_cast<std::uint32_t>(std::floor(from.max_distance_mm() * 4));
    }
    wish.min_quality = static_cast<std::uint8_t>(from.min_quality());
}

}  // namespace

Result<frame::Wish, Refusal> frame_wish(v1::Subscribe& subscribe) {
    if (auto refused = check_all(subscribe)) {
        return std::move(*refused);
    }
    understand(subscribe);
    frame::Wish wish;
    wish.kind = subscribe.kind() == v1::SECTOR ? frame::Kind::sector : frame::Kind::sweep;
    wish.format = format(subscribe);
    set_pace(subscribe, wish);
    set_range(subscribe, wish);
    wish.angles = frame::AngleSet(windows(subscribe.keep()), windows(subscribe.mask()));
    if (wish.angles.is_empty()) {
        return Refusal{
            "nothing_left",
            "keep and mask leave nothing of the circle",
            "samples in a window of mask are left out, whatever keep says"};
    }
    wish.every_nth = std::max(subscribe.every_nth(), 1U);
    wish.bins.count = subscribe.bins().count();
    if (subscribe.bins().pick() == v1::Bins::MINIMUM) {
        wish.bins.pick = frame::BinPick::minimum;
    }
    return wish;
}

}  // namespace sweepcast::stream
