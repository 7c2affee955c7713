// Chaos: random faults at several virtual lidars under a running gateway, and what must hold all
// along: see the help. Exit status 0 if it did. The seed makes the same faults in the same order;
// what they meet depends on the machine.
#include "tests/chaos/child.hpp"
#include "tests/chaos/faults.hpp"
#include "tests/chaos/watcher.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::chaos {
namespace {

using namespace std::chrono_literals;
using Seconds = std::chrono::duration<double>;

struct Options {
    std::uint64_t seed{1};
    std::size_t faults{200};
    std::size_t lidars{4};
    double rate{20};
    std::size_t faults_between{100};
    double bound_s{15};
    std::size_t growth_mb{32};
    bool damage{true};
};

class Chaos {
public:
    explicit Chaos(const Options& options)
        : options_(options)
        , random_(options.seed)
        , rig_(options.lidars)
        , watcher_(std::make_unique<Watcher>(rig_.gateway->tcp(), rig_.lidars))
        , victims_(options.lidars) {}

    void run() {
        quiet_window();  // all of them scan for the first time
        first_descriptors_ = rig_.gateway->descriptors();
        recoveries_s_.clear();
        while (thrown_ < options_.faults) {
            choose_damage();
            const auto until = std::min(options_.faults, thrown_ + options_.faults_between);
            while (thrown_ < until) {
                throw_fault();
            }
            quiet_window();
            check_gateway();
        }
        stop();
    }

    void print_summary() const {
        auto sorted = recoveries_s_;
        std::ranges::sort(sorted);
        const auto totals = watcher_totals_;
        fmt::print(
            "seed {}: {} faults, {} quiet windows; recovery median {:.1f} s, worst {:.1f} s ({}); "
            "{} descriptors then and now; RSS {} MB after the first window, {} MB at most; {} "
            "sweeps, "
            "{} skipped, {} told dropped; compared {} samples of {} sweeps ({} with holes), {} "
            "sweeps "
            "not compared, {} with losses told not found; {} power cycles of failed lidars; "
            "stopped in {:.2f} s\n",
            options_.seed,
            thrown_,
            windows_ - 1,
            sorted.at(sorted.size() / 2),
            sorted.back(),
            worst_,
            first_descriptors_,
            first_resident_ >> 20U,
            most_resident_ >> 20U,
            totals.sweeps,
            totals.skipped,
            totals.dropped,
            totals.samples_compared,
            totals.sweeps_compared,
            totals.sweeps_with_holes,
            totals.sweeps_not_compared,
            totals.sweeps_not_found,
            power_cycles_,
            stop_s_
        );
    }

    [[nodiscard]] std::string log_tail() const { return rig_.gateway->log_tail(); }

private:
    struct Ending {
        Clock::time_point at;
        std::string command;
    };
    struct Victim {
        std::vector<Ending> endings;
        bool unplugged{};
        bool damage_allowed{};
        std::vector<std::string> history;  ///< since the last quiet window
    };

    double random(double from, double to) {
        return std::uniform_real_distribution<double>(from, to)(random_);
    }
    std::size_t pick(std::size_t count) {
        return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
    }

    /// On half of the lines bytes are changed until the next quiet window; what the others deliver
    /// is compared all along.
    void choose_damage() {
        for (std::size_t i = 0; i < victims_.size(); ++i) {
            victims_[i].damage_allowed = options_.damage && random(0, 1) < 0.5;
            if (victims_[i].damage_allowed) {
                watcher_->set_damaged(i, true);
            }
        }
    }

    void tell(std::size_t number, const std::string& command) {
        auto& victim = victims_[number];
        if (const auto refusal = rig_.lidars[number]->tell(command); !refusal.empty()) {
            throw std::runtime_error(
                fmt::format("{}: \"{}\": {}", rig_.lidars[number]->link(), command, refusal)
            );
        }
        victim.history.push_back(command);
        victim.unplugged = command == "unplug" || (victim.unplugged && command != "replug");
    }

    void end_faults(Clock::time_point now) {
        for (std::size_t i = 0; i < victims_.size(); ++i) {
            auto due = std::exchange(victims_[i].endings, {});
            for (auto& ending : due) {
                if (ending.at > now) {
                    victims_[i].endings.push_back(std::move(ending));
                } else {
                    tell(i, ending.command);
                }
            }
        }
    }

    void throw_fault() {
        const auto next =
            Clock::now() +
            std::chrono::duration_cast<Clock::duration>(Seconds(random(0.2, 1.8) / options_.rate));
        watcher_->wait_until(next);
        end_faults(Clock::now());
        if (!rig_.gateway->lives()) {
            throw std::runtime_error("the gateway has died");
        }
        // Chosen before it is known what is possible, so that the seed alone decides.
        const auto number = pick(victims_.size());
        const auto& fault = faults.at(pick(faults.size()));
        const auto lasts = Seconds(random(0, 1) < 0.8 ? random(0.01, 0.5) : random(0.5, 3));
        auto& victim = victims_[number];
        if (fault.damages && !victim.damage_allowed) {
            return;
        }
        if (victim.unplugged && !fault.command.starts_with("fault")) {
            return;
        }
        if (fault.ends_with.empty()) {
            // Some need a scan that runs.
            if (rig_.lidars[number]->tell(std::string(fault.command)).empty()) {
                victim.history.emplace_back(fault.command);
                ++thrown_;
            }
        } else {
            tell(number, std::string(fault.command));
            ++thrown_;
            victim.endings.push_back(
                {Clock::now() + std::chrono::duration_cast<Clock::duration>(lasts),
                 std::string(fault.ends_with)}
            );
        }
    }

    /// Every fault ends, and every lidar must scan within the bound.
    void quiet_window() {
        ++windows_;
        std::vector<std::uint64_t> before;
        std::vector<Clock::time_point> begun;
        for (std::size_t i = 0; i < victims_.size(); ++i) {
            victims_[i].endings.clear();
            if (victims_[i].unplugged) {
                tell(i, "replug");
            }
            tell(i, "clear");
            before.push_back(watcher_->seen(i).sweeps);
            begun.push_back(Clock::now());
        }
        std::vector<bool> power_cycled(victims_.size());
        for (std::size_t i = 0; i < victims_.size(); ++i) {
            const auto bound =
                std::chrono::duration_cast<Clock::duration>(Seconds(options_.bound_s));
            const auto well = [&] {
                const auto seen = watcher_->seen(i);
                // Out of resets, as promised, until someone lends a hand.
                if (seen.lidar.state() == v1::Lidar::FAILED && !power_cycled[i]) {
                    power_cycled[i] = true;
                    ++power_cycles_;
                    tell(i, "reboot");
                    begun[i] = Clock::now();
                }
                return seen.lidar.state() == v1::Lidar::SCANNING && seen.sweeps >= before[i] + 2;
            };
            while (!watcher_->wait_until(begun[i] + bound, well)) {
                if (Clock::now() > begun[i] + bound) {
                    fail_recovery(i);
                }
            }
            const auto took =
                std::max(Seconds(watcher_->seen(i).last_sweep - begun[i]).count(), 0.0);
            if (recoveries_s_.empty() || took > *std::ranges::max_element(recoveries_s_)) {
                worst_ = fmt::format("{} after {}", rig_.lidars[i]->model(), history(i, 4));
            }
            recoveries_s_.push_back(took);
        }
        for (std::size_t i = 0; i < victims_.size(); ++i) {
            watcher_->set_damaged(i, false);
            victims_[i].history.clear();
        }
    }

    [[nodiscard]] std::string history(std::size_t number, std::size_t most) const {
        const auto& all = victims_[number].history;
        std::string text;
        for (auto i = all.size() - std::min(most, all.size()); i < all.size(); ++i) {
            text += (text.empty() ? "" : ", ") + all[i];
        }
        return text;
    }

    [[noreturn]] void fail_recovery(std::size_t number) const {
        const auto seen = watcher_->seen(number);
        throw std::runtime_error(fmt::format(
            "{} ({}) does not scan {} s after its faults ended; it is in state {}: {}; its last "
            "sweep "
            "({}) came {:.1f} s ago; line: {}; before: {}",
            rig_.lidars[number]->link(),
            rig_.lidars[number]->model(),
            options_.bound_s,
            v1::Lidar::State_Name(seen.lidar.state()),
            seen.lidar.cause(),
            seen.sequence,
            Seconds(Clock::now() - seen.last_sweep).count(),
            seen.lidar.line().ShortDebugString(),
            history(number, 30)
        ));
    }

    /// In a quiet window.
    void check_gateway() {
        if (!watcher_->wait_until(Clock::now() + 10s, [&] {
                return rig_.gateway->descriptors() <= first_descriptors_;
            })) {
            throw std::runtime_error(fmt::format(
                "the gateway has {} descriptors, and had {}",
                rig_.gateway->descriptors(),
                first_descriptors_
            ));
        }
        if (!watcher_->wait_until(Clock::now() + 5s, [&] {
                const auto totals = watcher_->totals();
                return totals.skipped == totals.dropped;
            })) {
            const auto totals = watcher_->totals();
            throw std::runtime_error(fmt::format(
                "{} sweeps did not come, {} were told of",
                totals.skipped,
                totals.dropped
            ));
        }
        const auto resident = rig_.gateway->resident_bytes();
        if (first_resident_ == 0) {
            first_resident_ = resident;
        }
        most_resident_ = std::max(most_resident_, resident);
        if (most_resident_ > first_resident_ + (options_.growth_mb << 20U)) {
            throw std::runtime_error(fmt::format(
                "the gateway's memory grew from {} to {} MB",
                first_resident_ >> 20U,
                most_resident_ >> 20U
            ));
        }
    }

    void stop() {
        watcher_totals_ = watcher_->totals();
        watcher_.reset();
        const auto begin = Clock::now();
        const int code = rig_.gateway->stop();
        stop_s_ = Seconds(Clock::now() - begin).count();
        if (code != 0 || stop_s_ > 2.0) {
            throw std::runtime_error(
                fmt::format("the gateway ended with {} after {:.2f} s", code, stop_s_)
            );
        }
    }

    Options options_;
    std::mt19937_64 random_;
    Rig rig_;
    std::unique_ptr<Watcher> watcher_;
    std::vector<Victim> victims_;
    std::vector<double> recoveries_s_;
    std::string worst_;
    Totals watcher_totals_;
    std::size_t thrown_{};
    std::size_t windows_{};
    std::size_t power_cycles_{};
    std::size_t first_descriptors_{};
    std::size_t first_resident_{};
    std::size_t most_resident_{};
    double stop_s_{};
};

int run(const Options& options) {
    std::unique_ptr<Chaos> chaos;
    try {
        chaos = std::make_unique<Chaos>(options);
        chaos->run();
        chaos->print_summary();
        return 0;
    } catch (const std::exception& failure) {
        fmt::print(
            "FAILED with seed {}: {}\n{}",
            options.seed,
            failure.what(),
            chaos ? "the gateway's log ends with:\n" + chaos->log_tail() : ""
        );
        return 1;
    }
}

}  // namespace
}  // namespace sweepcast::chaos

int main(int count, char** arguments) {
    sweepcast::chaos::Options options;
    CLI::App app(
        "Random faults at virtual lidars under a running gateway. All along: the gateway lives, "
        "its "
        "subscriber stays connected, numbers of sweeps rise, those left out are those it tells of, "
        "and of lidars whose line changes no bytes each sample was measured so (angle, distance, "
        "quality; in order, none twice), but next to losses that it tells of. In quiet windows: "
        "every lidar scans within the bound, descriptors and memory are as before. At the end: it "
        "stops within 2 s, with exit status 0."
    );
    app.add_option("--seed", options.seed);
    app.add_option("--faults", options.faults, "how many");
    app.add_option("--lidars", options.lidars)->check(CLI::Range(1, 64));
    app.add_option("--rate", options.rate, "faults a second")->check(CLI::Range(0.1, 1000.0));
    app.add_option("--between", options.faults_between, "faults from one quiet window to the next")
        ->check(CLI::Range(1, 1'000'000));
    app.add_option("--bound", options.bound_s, "seconds until every lidar must scan again");
    app.add_option("--growth", options.growth_mb, "megabytes by which the gateway may grow");
    app.add_flag("!--no-damage", options.damage, "no faults that change bytes");
    CLI11_PARSE(app, count, arguments);
    return sweepcast::chaos::run(options);
}
