// Isolation: of several virtual lidars under one gateway one misbehaves in every way in turn. The
// others must not lose one sample, and HTTP must answer as before: see the help.
#include "tests/bench/beat.hpp"
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
#include <stdexcept>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace sweepcast::chaos {
namespace {

using namespace std::chrono_literals;
using Milliseconds = std::chrono::duration<double, std::milli>;

struct Options {
    std::size_t lidars{8};
    double fault_s{2};
};

/// Asks the gateway for its lidars fifty times a second, in a thread of its own.
class HttpClient {
public:
    explicit HttpClient(std::string address)
        : address_(std::move(address))
        , thread_([this](const std::stop_token& stop) { run(stop); }) {}

    /// Ends it; how many milliseconds each answer took, the quickest first. Throws if one did not
    /// come.
    std::vector<double> finish() {
        thread_.request_stop();
        thread_.join();
        if (!failure_.empty()) {
            throw std::runtime_error("HTTP: " + failure_);
        }
        std::ranges::sort(took_ms_);
        return std::move(took_ms_);
    }

private:
    void run(const std::stop_token& stop) {
        bench::Beat beat(50);
        while (!stop.stop_requested() && failure_.empty()) {
            beat.wait();
            ask();
        }
    }

    void ask() {
        const auto begin = Clock::now();
        try {
            const auto answer = test::http(address_, "GET", "/api/v1/lidars");
            if (answer.status != 200) {
                failure_ = fmt::format("the status was {}", answer.status);
            }
        } catch (const std::exception& failure) {
            failure_ = failure.what();
        }
        took_ms_.push_back(Milliseconds(Clock::now() - begin).count());
    }

    std::string address_;
    std::string failure_;
    std::vector<double> took_ms_;
    std::jthread thread_;
};

class Isolation {
public:
    explicit Isolation(const Options& options) : options_(options), rig_(options.lidars) {
        watcher_.set_damaged(0, true);
    }

    void run() {
        const auto all_scan = [this] {
            for (std::size_t i = 0; i < rig_.lidars.size(); ++i) {
                if (watcher_.seen(i).sweeps < 5) {
                    return false;
                }
            }
            return true;
        };
        if (!watcher_.wait_until(Clock::now() + 30s, all_scan)) {
            throw std::runtime_error("not all of them scan");
        }
        for (std::size_t i = 0; i < rig_.lidars.size(); ++i) {
            first_.push_back(watcher_.seen(i));
        }
        HttpClient http(rig_.gateway->http());
        for (const auto& fault : faults) {
            suffer(fault);
        }
        // What was measured last is compared by then.
        watcher_.wait_until(Clock::now() + 6s);
        check("the end");
        print(http.finish());
    }

private:
    void suffer(const Fault& fault) {
        const auto lasts = std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(options_.fault_s)
        );
        (void)rig_.lidars.front()->tell(std::string(fault.command));  // some need a scan that runs
        watcher_.wait_until(Clock::now() + lasts);
        if (!fault.ends_with.empty()) {
            (void)rig_.lidars.front()->tell(std::string(fault.ends_with));
        }
        check(fault.command);
        if (watcher_.seen(0).lidar.state() == v1::Lidar::FAILED) {
            (void)rig_.lidars.front()->tell("reboot");
        }
        watcher_.wait_until(Clock::now() + lasts / 2);
    }

    /// That the others scan on as if nothing was.
    void check(std::string_view after) const {
        for (std::size_t i = 1; i < rig_.lidars.size(); ++i) {
            const auto seen = watcher_.seen(i);
            const auto& then = first_[i].lidar;
            const bool same =
                seen.skipped == 0 && seen.lidar.state_changes() == then.state_changes() &&
                seen.lidar.line().checksum_errors() == then.line().checksum_errors() &&
                seen.lidar.line().lost_packets() == then.line().lost_packets();
            if (!same) {
                throw std::runtime_error(fmt::format(
                    "after {}: {} suffers, too: {} sweeps skipped; {}",
                    after,
                    rig_.lidars[i]->link(),
                    seen.skipped,
                    seen.lidar.ShortDebugString()
                ));
            }
        }
        const auto totals = watcher_.totals();
        if (totals.sweeps_with_holes + totals.sweeps_not_found + totals.dropped > 0) {
            throw std::runtime_error(fmt::format(
                "after {}: {} sweeps of the others have holes, {} were not found, {} dropped",
                after,
                totals.sweeps_with_holes,
                totals.sweeps_not_found,
                totals.dropped
            ));
        }
    }

    void print(const std::vector<double>& took_ms) const {
        const auto totals = watcher_.totals();
        fmt::print(
            "{} lidars, the first of which suffered {} faults: the others' {} sweeps came without "
            "a "
            "gap, all {} samples as measured, none lost; HTTP: {} answers, median {:.1f} ms, 99 % "
            "{:.1f} ms, worst {:.1f} ms\n",
            rig_.lidars.size(),
            faults.size(),
            totals.sweeps_compared,
            totals.samples_compared,
            took_ms.size(),
            took_ms.at(took_ms.size() / 2),
            took_ms.at(took_ms.size() * 99 / 100),
            took_ms.back()
        );
    }

    Options options_;
    Rig rig_;
    Watcher watcher_{rig_.gateway->tcp(), rig_.lidars};
    std::vector<Seen> first_;
};

}  // namespace
}  // namespace sweepcast::chaos

int main(int count, char** arguments) {
    sweepcast::chaos::Options options;
    CLI::App app(
        "Virtual lidars under one gateway, the first of which misbehaves in every way in turn. The "
        "others: no state changes, no sweep is skipped, no packet is lost or damaged, and every "
        "sample that they measured comes, as it was measured. Meanwhile the API is asked fifty "
        "times a second."
    );
    app.add_option("--lidars", options.lidars)->check(CLI::Range(2, 64));
    app.add_option("--fault-seconds", options.fault_s, "how long each fault lasts");
    CLI11_PARSE(app, count, arguments);
    try {
        sweepcast::chaos::Isolation(options).run();
    } catch (const std::exception& failure) {
        fmt::print("FAILED: {}\n", failure.what());
        return 1;
    }
    return 0;
}
