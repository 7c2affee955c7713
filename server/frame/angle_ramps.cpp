// Ramps are found by trying each sample for the first of a packet: there the lidar's own angle
// shows, a whole number of 1/64 degrees, and from one packet's to the next all others must follow.
#include "server/frame/angle_ramps.hpp"

#include "driver/protocol/ultra_code.hpp"
#include "server/frame/angle_units.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace sweepcast::frame {

namespace {

using protocol::AnswerType;
using protocol::Sample;
using Samples = std::span<const Sample>;

/// Parts of 1/64 degree that the vendor's decoders reckon with.
constexpr std::int64_t parts = 1024;
/// Corrections are in 1/8 degree.
constexpr std::int32_t correction_unit = 8;
/// How far from where it is expected the start of a ramp is looked for, in 1/64 degrees.
constexpr std::int32_t search_width = 12;
/// With more exceptions than one in so many samples, ramps are not worth it.
constexpr std::size_t samples_per_exception = 12;

/// What makes an angle differ from its place on the ramp.
enum class Spread { even, by_distance, by_correction };

struct Shape {
    std::uint32_t length{};
    Spread spread{};
};

/// None of answers that have an angle for each sample.
std::optional<Spread> spread_of(AnswerType type) {
    switch (type) {
    case AnswerType::express:
        return Spread::by_correction;
    case AnswerType::ultra:
        return Spread::by_distance;
    case AnswerType::dense:
    case AnswerType::ultra_dense:
        return Spread::even;
    case AnswerType::normal:
    case AnswerType::hq:
        break;
    }
    return std::nullopt;
}

std::int64_t offset_of(const Sample& sample) {
    return protocol::ultra_angle_offset_q16(static_cast<std::int32_t>(sample.distance.raw));
}

std::int64_t round_down(std::int64_t value, std::int64_t by) {
    return value / by - (value % by < 0 ? 1 : 0);
}

/// The place of a ramp's sample, in parts.
std::int64_t place(std::int32_t start, std::int32_t end, std::uint32_t length, std::uint32_t k) {
    const std::int64_t increment = round_down((std::int64_t{end} - start) * parts, length);
    return start * parts + k * increment;
}

class Fitter {
public:
    Fitter(Samples samples, const Shape& shape)
        : shape_(shape)
        , count_(static_cast<std::uint32_t>(samples.size())) {
        angles_.reserve(count_);
        lows_.reserve(count_);
        constexpr auto turn = static_cast<std::int32_t>(q6_per_turn);
        auto angle = static_cast<std::int32_t>(to_q6(samples.front().angle));
        for (const auto& sample : samples) {
            std::int32_t step = static_cast<std::int32_t>(to_q6(sample.angle)) - angle % turn;
            step += step < -turn / 2 ? turn : 0;
            step -= step > turn / 2 ? turn : 0;
            angle += step;
            angles_.push_back(angle);
            const bool shifted = shape.spread == Spread::by_distance;
            lows_.push_back(angle * parts + (shifted ? offset_of(sample) : 0));
        }
        per_ramp_ = estimate();
    }

    std::optional<AngleRamps> fit() {
        std::size_t allowed = count_ / samples_per_exception;
        std::optional<AngleRamps> best;
        const std::uint32_t phases = std::min(shape_.length, count_);
        for (std::uint32_t phase = 0; phase < phases; ++phase) {
            const auto missed = try_phase(phase, allowed);
            if (!missed) {
                continue;
            }
            best = AngleRamps{};
            best->length = shape_.length;
            best->skip = (shape_.length - phase) % shape_.length;
            best->starts = starts_;
            best->parallax = shape_.spread == Spread::by_distance;
            if (*missed == 0) {
                break;
            }
            allowed = *missed - 1;
        }
        if (best) {
            note_differences(*best);
        }
        return best;
    }

private:
    /// How far a ramp rises, about.
    [[nodiscard]] std::int32_t estimate() const {
        if (count_ < 2) {
            return 0;
        }
        if (shape_.spread == Spread::by_correction && count_ > shape_.length) {
            // Corrections change now and then: most samples a ramp apart have the same.
            std::vector<std::int32_t> rises;
            for (std::size_t i = shape_.length; i < count_; ++i) {
                rises.push_back(angles_[i] - angles_[i - shape_.length]);
            }
            const auto middle = rises.begin() + static_cast<std::ptrdiff_t>(rises.size() / 2);
            std::nth_element(rises.begin(), middle, rises.end());
            return *middle;
        }
        return static_cast<std::int32_t>(
            (lows_.back() - lows_.front()) * shape_.length / (count_ - 1) / parts
        );
    }

    /// Whether this sample can be there.
    [[nodiscard]] bool lies_on(std::size_t sample, std::int64_t place) const {
        if (shape_.spread == Spread::by_correction) {
            return (round_down(place, parts) - angles_[sample]) % correction_unit == 0;
        }
        return place >= lows_[sample] && place < lows_[sample] + parts;
    }

    /// The start of a ramp whose first sample is this one, near `expected` if there is a choice.
    [[nodiscard]] std::int32_t start_at(std::size_t sample, std::int32_t expected) const {
        if (shape_.spread == Spread::by_correction) {
            const std::int64_t off = expected - angles_[sample] + correction_unit / 2;
            return angles_[sample] +
                   static_cast<std::int32_t>(round_down(off, correction_unit)) * correction_unit;
        }
        return static_cast<std::int32_t>(-round_down(-lows_[sample], parts));
    }

    /// How many of the samples from `first` on, number `k` of their ramp and up, do not lie on it;
    /// no more than `most` are counted.
    [[nodiscard]] std::size_t misses(
        std::size_t first,
        std::uint32_t k,
        std::pair<std::int32_t, std::int32_t> ends,
        std::size_t most
    ) const {
        const std::int64_t increment =
            round_down((std::int64_t{ends.second} - ends.first) * parts, shape_.length);
        std::int64_t at = ends.first * parts + k * increment;
        std::size_t missed = 0;
        for (std::size_t i = first; k < shape_.length && i < count_ && missed < most; ++i, ++k) {
            missed += lies_on(i, at) ? 0U : 1U;
            at += increment;
        }
        return missed;
    }

    /// Of the ramps that `make_ends` gives for offsets around 0, the offset of the best; `missed`
    /// in and out.
    template <class MakeEnds>
    [[nodiscard]] std::int32_t
    search(std::size_t first, std::uint32_t k, MakeEnds make_ends, std::size_t& missed) const {
        std::int32_t best = 0;
        for (std::int32_t width = 1; width <= search_width && missed > 0; ++width) {
            for (const std::int32_t offset : {width, -width}) {
                const auto now = misses(first, k, make_ends(offset), missed);
                if (now < missed) {
                    missed = now;
                    best = offset;
                }
            }
        }
        return best;
    }

    /// The samples that lie on no ramp if this one is the first of a packet, and starts_; nothing
    /// if there are more than `allowed`.
    std::optional<std::size_t> try_phase(std::uint32_t phase, std::size_t allowed) {
        starts_.assign(1, start_at(phase, angles_[phase]));
        std::size_t missed = 0;
        for (std::size_t knot = phase; knot < count_; knot += shape_.length) {
            missed += add_ramp(knot);
            if (missed > allowed) {
                return std::nullopt;
            }
        }
        if (phase > 0) {
            missed += put_ramp_in_front(phase);
        }
        return missed <= allowed ? std::optional(missed) : std::nullopt;
    }

    /// Adds the end of the ramp that begins with sample `knot`. Gives how many samples missed it.
    std::size_t add_ramp(std::size_t knot) {
        const auto start = starts_.back();
        const auto rise = starts_.size() > 1 ? start - starts_[starts_.size() - 2] : per_ramp_;
        const auto next = knot + shape_.length;
        const auto end = next < count_ ? start_at(next, start + rise) : start + rise;
        auto missed = misses(knot, 0, {start, end}, shape_.length);
        if (next < count_ && missed > shape_.length / samples_per_exception) {
            starts_.push_back(end);  // most likely no packet begins here
            return missed;
        }
        const auto make_ends = [&](std::int32_t offset) { return std::pair(start, end + offset); };
        starts_.push_back(end + search(knot, 0, make_ends, missed));
        return missed;
    }

    /// Puts the start of the ramp in front whose last samples are the first `count`.
    std::size_t put_ramp_in_front(std::uint32_t count) {
        const auto end = starts_[0];
        const auto start = end - (starts_[1] - end);
        const std::uint32_t k = shape_.length - count;
        auto missed = misses(0, k, {start, end}, count);
        const auto make_ends = [&](std::int32_t offset) { return std::pair(start + offset, end); };
        starts_.insert(starts_.begin(), start + search(0, k, make_ends, missed));
        return missed;
    }

    /// Notes what the samples differ by from their places.
    void note_differences(AngleRamps& ramps) const {
        for (std::uint32_t i = 0; i < count_; ++i) {
            const auto ramp = (ramps.skip + i) / ramps.length;
            const auto at = place(
                ramps.starts[ramp],
                ramps.starts[ramp + 1],
                ramps.length,
                (ramps.skip + i) % ramps.length
            );
            const std::int64_t shift = lows_[i] - angles_[i] * parts;
            auto rest = static_cast<std::int32_t>(angles_[i] - round_down(at - shift, parts));
            if (shape_.spread == Spread::by_correction) {
                const auto correction = static_cast<std::int32_t>(
                    round_down(-rest + correction_unit / 2, correction_unit)
                );
                ramps.corrections.push_back(correction);
                rest += correction * correction_unit;
            }
            if (rest != 0) {
                ramps.fixes.push_back({i, rest});
            }
        }
    }

    Shape shape_;
    std::uint32_t count_;
    std::vector<std::int32_t> angles_;  ///< in 1/64 degrees, not wrapped
    std::vector<std::int64_t> lows_;    ///< least place of each sample, in parts
    std::int32_t per_ramp_{};
    std::vector<std::int32_t> starts_;  ///< of the phase being tried
};

}  // namespace

std::optional<AngleRamps> fit_ramps(Samples samples, AnswerType type) {
    const auto spread = spread_of(type);
    if (!spread || samples.empty()) {
        return std::nullopt;
    }
    const auto length = static_cast<std::uint32_t>(protocol::samples_per_packet(type));
    return Fitter(samples, {length, *spread}).fit();
}

void apply_ramps(const AngleRamps& ramps, std::span<Sample> samples) {
    constexpr std::int64_t turn = q6_per_turn;
    std::size_t fix = 0;
    for (std::uint32_t i = 0; i < samples.size(); ++i) {
        const std::size_t ramp = (ramps.skip + i) / ramps.length;
        const auto at = place(
            ramps.starts[ramp],
            ramps.starts[ramp + 1],
            ramps.length,
            (ramps.skip + i) % ramps.length
        );
        std::int64_t angle = round_down(at - (ramps.parallax ? offset_of(samples[i]) : 0), parts);
        angle -=
            ramps.corrections.empty() ? 0 : std::int64_t{ramps.corrections[i]} * correction_unit;
        if (fix < ramps.fixes.size() && ramps.fixes[fix].index == i) {
            angle += ramps.fixes[fix++].add;
        }
        angle = (angle % turn + turn) % turn;
        samples[i].angle = from_q6(static_cast<std::uint32_t>(angle));
    }
}

}  // namespace sweepcast::frame
