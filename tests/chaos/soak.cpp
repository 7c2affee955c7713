// Soak: virtual lidars at their own rates under one gateway for long. Memory must stay flat,
// descriptors must not grow, no sample may be missing or wrong, and the samples' times must not
// drift against the wall clock: see the help.
#include "tests/chaos/child.hpp"
#include "tests/chaos/watcher.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace sweepcast::chaos {
namespace {

using namespace std::chrono_literals;
using Milliseconds = std::chrono::duration<double, std::milli>;

struct Options {
    double minutes{60};
    double report_s{60};
    std::size_t growth_kb{2048};
};

Clock::duration seconds(double count) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(count));
}

/// How old the last sample of each sweep was when the sweep was here, by the wall clock.
using Ages = std::map<std::string, std::vector<Milliseconds>>;

void take_age(Ages& ages, const test::ReceivedSweep& sweep) {
    const auto& samples = sweep.scan.sweep.samples;
    if (!samples.empty()) {
        const auto now = std::chrono::system_clock::now().time_since_epoch();
        ages[sweep.lidar].emplace_back(now - sweep.scan.unix_time(samples.back()).value());
    }
}

Milliseconds median(std::vector<Milliseconds> ages) {
    const auto middle = ages.begin() + std::ssize(ages) / 2;
    std::ranges::nth_element(ages, middle);
    return *middle;
}

class Soak {
public:
    explicit Soak(const Options& options) : options_(options) {}

    void run() {
        test::Subscriber client("ws://" + rig_.gateway->http() + "/api/v1/stream");
        client.subscribe();
        fmt::print(
            "{:>8} {:>10} {:>12} {:>10} {:>8}  {}\n",
            "minutes",
            "RSS, kB",
            "descriptors",
            "sweeps",
            "skipped",
            "typical age of each lidar's sweeps, ms"
        );
        const auto begin = Clock::now() + seconds(options_.report_s);  // all have settled by then
        first_ = take_report(client, begin, 0);
        for (double s = options_.report_s; s <= options_.minutes * 60; s += options_.report_s) {
            last_ = take_report(client, begin + seconds(s), s / 60);
            most_resident_kb_ = std::max(most_resident_kb_, last_.resident_kb);
            for (const auto& [lidar, age] : last_.ages) {
                most_drift_ =
                    std::max(most_drift_, Milliseconds(std::chrono::abs(age - first_.ages[lidar])));
            }
        }
        judge();
    }

private:
    struct Report {
        std::size_t resident_kb{};
        std::size_t descriptors{};
        std::map<std::string, Milliseconds> ages;  ///< medians
    };

    static std::map<std::string, Milliseconds>
    ages_until(test::Subscriber& client, Clock::time_point then) {
        Ages ages;
        while (Clock::now() < then) {
            take_age(ages, client.next_sweep());
        }
        std::map<std::string, Milliseconds> typical;
        for (auto& [lidar, all] : ages) {
            typical.emplace(lidar, median(std::move(all)));
        }
        return typical;
    }

    Report take_report(test::Subscriber& client, Clock::time_point due, double minutes) {
        Report report;
        report.ages = ages_until(client, due);
        report.resident_kb = rig_.gateway->resident_bytes() / 1024;
        report.descriptors = rig_.gateway->descriptors();
        const auto totals = watcher_.totals();
        std::string ages;
        for (const auto& [lidar, age] : report.ages) {
            ages += fmt::format(" {:.2f}", age.count());
        }
        fmt::print(
            "{:8.1f} {:10} {:12} {:10} {:8} {}\n",
            minutes,
            report.resident_kb,
            report.descriptors,
            totals.sweeps,
            totals.skipped,
            ages
        );
        std::fflush(stdout);
        return report;
    }

    void judge() {
        watcher_.wait_until(Clock::now() + 1s);  // what broke throws
        const auto totals = watcher_.totals();
        fmt::print(
            "{} lidars for {:.0f} min: RSS {} kB then, {} kB now, {} kB at most; descriptors {} "
            "and {}; {} sweeps, {} "
            "skipped; {} samples compared, all as measured; the samples' times against the wall "
            "clock: at most {:.2f} ms "
            "from where they were\n",
            rig_.lidars.size(),
            options_.minutes,
            first_.resident_kb,
            last_.resident_kb,
            most_resident_kb_,
            first_.descriptors,
            last_.descriptors,
            totals.sweeps,
            totals.skipped,
            totals.samples_compared,
            most_drift_.count()
        );
        if (last_.descriptors > first_.descriptors) {
            throw std::runtime_error("descriptors grew");
        }
        if (most_resident_kb_ > first_.resident_kb + options_.growth_kb) {
            throw std::runtime_error("memory grew");
        }
        if (totals.skipped > 0 || totals.dropped > 0) {
            throw std::runtime_error("sweeps are missing");
        }
    }

    Options options_;
    Rig rig_{4};
    Watcher watcher_{rig_.gateway->tcp(), rig_.lidars};
    Report first_;
    Report last_;
    std::size_t most_resident_kb_{};
    Milliseconds most_drift_{};
};

}  // namespace
}  // namespace sweepcast::chaos

int main(int count, char** arguments) {
    sweepcast::chaos::Options options;
    CLI::App app(
        "Four virtual lidars of different families at their own rates under one gateway, two "
        "subscribers, and nothing else. Each minute: the gateway's memory and descriptors, and how "
        "old the sweeps of each lidar typically were when they came, by the wall-clock times of "
        "their last samples, which tells of a drift. Fails if memory or descriptors grow, or a "
        "sweep is "
        "missing or not as it was measured."
    );
    app.add_option("--minutes", options.minutes)->check(CLI::Range(0.1, 1e5));
    app.add_option("--report-seconds", options.report_s)->check(CLI::Range(1.0, 3600.0));
    app.add_option("--growth-kb", options.growth_kb, "by which memory may grow");
    CLI11_PARSE(app, count, arguments);
    try {
        sweepcast::chaos::Soak(options).run();
    } catch (const std::exception& failure) {
        fmt::print("FAILED: {}\n", failure.what());
        return 1;
    }
    return 0;
}
