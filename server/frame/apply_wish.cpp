#include "server/frame/apply_wish.hpp"

#include "server/frame/angle_units.hpp"

#include <limits>
#include <utility>

namespace sweepcast::frame {

namespace {

using protocol::Sample;
using Samples = std::span<const Sample>;

bool clips(const Wish& wish) {
    return wish.nearest.raw > 0 || wish.farthest.raw < std::numeric_limits<std::uint32_t>::max() ||
           wish.min_quality > 0;
}

bool changes_samples(const Wish& wish) {
    return wish.every_nth > 1 || !wish.angles.is_whole_circle() || clips(wish) ||
           wish.bins.count > 0;
}

Sample without_echo(Sample sample) {
    sample.distance = {};
    sample.quality = 0;
    return sample;
}

Sample clipped(const Wish& wish, const Sample& sample) {
    const bool is_fine = !sample.distance.has_echo() || (sample.distance.raw >= wish.nearest.raw &&
                                                         sample.distance.raw <= wish.farthest.raw &&
                                                         sample.quality >= wish.min_quality);
    return is_fine ? sample : without_echo(sample);
}

/// Where the first sample is that is taken of those from number `first` of the sweep on.
std::size_t first_taken(const Wish& wish, std::size_t first) {
    const std::size_t over = first % wish.every_nth;
    return over == 0 ? 0 : wish.every_nth - over;
}

void select(const Wish& wish, Samples samples, std::size_t first, std::vector<Sample>& out) {
    for (auto i = first_taken(wish, first); i < samples.size(); i += wish.every_nth) {
        if (wish.angles.contains(samples[i].angle)) {
            out.push_back(clipped(wish, samples[i]));
        }
    }
}

/// While bins are being filled, the flag of each says how its sample came there.
enum Filling : std::uint8_t { empty, left_out, measured };

/// Bins, each with its best sample so far, whose angle is still its own.
class BinFiller {
public:
    BinFiller(const Bins& bins, std::vector<Sample>& out) : bins_(bins), out_(out) {
        out_.assign(bins.count, Sample{});
    }

    /// Offers a sample to its bin.
    void offer(Sample sample, Filling how) {
        const std::uint32_t bin = sample.angle.raw * bins_.count / q14_per_turn;
        sample.flag = how;
        auto& holder = out_[bin];
        if (how > holder.flag || (how == holder.flag && is_better(sample, holder, bin))) {
            holder = sample;
        }
    }

    /// Puts every sample into the middle of its bin, and gives those that are empty a time.
    void finish() {
        guess_times();
        for (std::uint32_t bin = 0; bin < bins_.count; ++bin) {
            out_[bin].angle = from_units(2 * bin + 1, 2 * bins_.count);
            out_[bin].flag = bin == 0 ? 1 : 0;
        }
    }

private:
    [[nodiscard]] bool is_better(const Sample& a, const Sample& b, std::uint32_t bin) const {
        if (bins_.pick == BinPick::minimum && a.distance != b.distance) {
            // No echo, which is 0, comes last.
            return a.distance.raw - 1 < b.distance.raw - 1;
        }
        return from_middle(a, bin) < from_middle(b, bin);
    }

    [[nodiscard]] std::int64_t from_middle(const Sample& sample, std::uint32_t bin) const {
        const std::int64_t angle = std::int64_t{2} * bins_.count * sample.angle.raw;
        const std::int64_t middle = (std::int64_t{2} * bin + 1) * q14_per_turn;
        return angle < middle ? middle - angle : angle - middle;
    }

    void guess_times() {
        std::size_t before = bins_.count;  // none
        for (std::size_t bin = 0; bin < bins_.count; ++bin) {
            if (out_[bin].flag == empty) {
                continue;
            }
            guess_times(before, bin);
            before = bin;
        }
        guess_times(before, bins_.count);
    }

    /// The times of the bins between two that have one, or from one to an end of the circle.
    void guess_times(std::size_t before, std::size_t after) {
        const bool has_before = before < bins_.count;
        const bool has_after = after < bins_.count;
        for (std::size_t bin = has_before ? before + 1 : 0; bin < after; ++bin) {
            if (has_before && has_after) {
                const auto steps = static_cast<std::int64_t>(after - before);
                const auto step = static_cast<std::int64_t>(bin - before);
                const auto whole = out_[after].time - out_[before].time;
                // Divided first: hostile times must not overflow.
                out_[bin].time =
                    out_[before].time + whole / steps * step + whole % steps * step / steps;
            } else if (has_before) {
                out_[bin].time = out_[before].time;
            } else if (has_after) {
                out_[bin].time = out_[after].time;
            }
        }
    }

    Bins bins_;
    std::vector<Sample>& out_;
};

void fill_bins(const Wish& wish, Samples samples, std::size_t first, std::vector<Sample>& out) {
    BinFiller filler(wish.bins, out);
    for (auto i = first_taken(wish, first); i < samples.size(); i += wish.every_nth) {
        if (wish.angles.contains(samples[i].angle)) {
            filler.offer(clipped(wish, samples[i]), measured);
        } else {
            filler.offer(without_echo(samples[i]), left_out);
        }
    }
    filler.finish();
}

}  // namespace

std::span<const Sample>
apply_wish(const Wish& wish, Samples samples, std::size_t first, std::vector<Sample>& memory) {
    if (!changes_samples(wish)) {
        return samples;
    }
    memory.clear();
    if (wish.bins.count > 0) {
        fill_bins(wish, samples, first, memory);
    } else {
        select(wish, samples, first, memory);
    }
    return memory;
}

}  // namespace sweepcast::frame
