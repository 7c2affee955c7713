// How long a scan is away: after the gateway was killed in mid-scan and started again, and after
// the lidar was unplugged and plugged in again. Virtual lidars, the real gateway, one TCP client.
// Usage: recovery_bench [ROUNDS [MODEL...]]
#include "sweepcast/v1/stream.pb.h"
#include "tests/e2e/gateway.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace sweepcast::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

/// Prints the smallest, the middle and the largest of these.
void print(const std::string& what, std::vector<double> ms) {
    std::ranges::sort(ms);
    fmt::print(
        "{:<58} {:7.0f} {:7.0f} {:7.0f}\n",
        what,
        ms.front(),
        ms.at(ms.size() / 2),
        ms.back()
    );
}

double ms_since(Clock::time_point begin) {
    return Milliseconds(Clock::now() - begin).count();
}

std::unique_ptr<test::Subscriber> subscribe(const test::GatewayProcess& gateway) {
    auto client = std::make_unique<test::Subscriber>("tcp://" + gateway.tcp);
    client->subscribe();
    return client;
}

/// Gateways killed in mid-scan: from the start of the next one until it scans, and to its first
/// sweep.
void kill_gateways(const std::string& model, std::size_t rounds) {
    const test::VirtualLidarProcess lidar({"--model", model});
    const std::vector<std::string> options{"--lidar", lidar.port};
    std::vector<double> scanning;
    std::vector<double> first_sweep;
    auto gateway = std::make_unique<test::GatewayProcess>(options);
    subscribe(*gateway)->next_sweep();
    for (std::size_t i = 0; i < rounds; ++i) {
        gateway->process.signal(SIGKILL);
        gateway->process.wait();
        const auto begin = Clock::now();
        gateway = std::make_unique<test::GatewayProcess>(options);
        const auto client = subscribe(*gateway);
        client->wait_for_state(v1::Lidar::SCANNING);
        scanning.push_back(ms_since(begin));
        client->next_sweep();
        first_sweep.push_back(ms_since(begin));
    }
    print(model + ": gateway killed, from its start until it scans", std::move(scanning));
    print(model + ": ... until a client has a sweep", std::move(first_sweep));
}

/// A lidar that is unplugged and plugged in again: until the gateway says so, and until it scans.
void unplug_lidar(const std::string& model, std::size_t rounds) {
    const test::ScratchDirectory scratch;
    const auto link = scratch.file("lidar");
    test::VirtualLidarProcess lidar({"--model", model, "--link", link});
    const test::GatewayProcess gateway({"--lidar", link});
    const auto client = subscribe(gateway);
    client->next_sweep();
    std::vector<double> noticed;
    std::vector<double> back;
    std::vector<double> swept;
    for (std::size_t i = 0; i < rounds; ++i) {
        auto begin = Clock::now();
        lidar.process.signal(SIGUSR1);
        client->next([](const auto& message) {
            return message.has_lidar() && message.lidar().state() != v1::Lidar::SCANNING;
        });
        noticed.push_back(ms_since(begin));
        lidar.process.wait_for_log("unplugged");
        begin = Clock::now();
        lidar.process.signal(SIGUSR1);
        client->wait_for_state(v1::Lidar::SCANNING);
        back.push_back(ms_since(begin));
        client->next_sweep();
        swept.push_back(ms_since(begin));
    }
    print(model + ": unplugged, until the gateway says so", std::move(noticed));
    print(model + ": plugged in again, until it scans", std::move(back));
    print(model + ": ... until a client has a sweep", std::move(swept));
}

void run(std::size_t rounds, const std::vector<std::string>& models) {
    fmt::print("{:<58} {:>7} {:>7} {:>7}\n", "milliseconds", "least", "median", "most");
    for (const auto& model : models) {
        kill_gateways(model, rounds);
        unplug_lidar(model, rounds);
    }
}

}  // namespace
}  // namespace sweepcast::bench

int main(int argc, char** argv) {
    try {
        std::vector<std::string> models(argv + std::min(argc, 2), argv + argc);
        if (models.empty()) {
            models = {"a1m8", "c1", "s2"};
        }
        sweepcast::bench::run(argc > 1 ? std::stoul(argv[1]) : 10, models);
    } catch (const std::exception& failure) {
        fmt::print(stderr, "{}\n", failure.what());
        return 1;
    }
    return 0;
}
