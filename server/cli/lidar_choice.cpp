#include "server/cli/lidar_choice.hpp"

#include "driver/device/probe.hpp"
#include "driver/link/discovery.hpp"
#include "driver/link/path_watch.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace sweepcast::cli {

namespace asio = boost::asio;

namespace {

constexpr const char* default_virtual = "virtual:a1m8";

std::vector<link::LinkUrl> links_of(const std::vector<gateway::LidarUrl>& lidars) {
    std::vector<link::LinkUrl> links;
    for (const auto& lidar : lidars) {
        if (const auto* link = std::get_if<link::LinkUrl>(&lidar.where)) {
            links.push_back(*link);
        }
    }
    return links;
}

/// The ports of lidars that are named but not there, by the serial numbers that they had in earlier
/// runs.
std::map<std::string, std::string>
known_but_absent(const std::vector<gateway::LidarUrl>& lidars, const gateway::LidarMemory& memory) {
    std::map<std::string, std::string> absent;
    for (const auto& link : links_of(lidars)) {
        const auto* port = std::get_if<link::SerialPlace>(&link.where);
        if (port == nullptr || link::PathLook(port->path).there()) {
            continue;
        }
        if (const auto known = memory.lidar_named_by(port->path)) {
            absent.emplace(known->serial, port->path);
        }
    }
    return absent;
}

}  // namespace

Result<LidarChoice, Problem> choose_lidars(
    const std::vector<std::string>& named,
    std::vector<std::string> patterns,
    const std::shared_ptr<spdlog::logger>& log
) {
    LidarChoice choice;
    std::set<std::string> places;
    for (const auto& text : named) {
        auto url = gateway::parse_lidar_url(text);
        if (!url) {
            return url.error();
        }
        const auto* link = std::get_if<link::LinkUrl>(&url->where);
        if (link != nullptr && !places.insert(link::place_key(*link)).second) {
            log->warn("--lidar {}: named before, perhaps by another name; taken once", text);
            continue;
        }
        choice.lidars.push_back(std::move(*url));
    }
    choice.find = choice.lidars.empty() || !patterns.empty();
    choice.patterns = std::move(patterns);
    return choice;
}

std::vector<std::string> patterns_of_environment() {
    std::vector<std::string> patterns;
    // Read before any thread is started.
    const char* value = std::getenv("SWEEPCAST_DISCOVER");  // NOLINT(concurrency-mt-unsafe): alone
    std::string_view rest = value != nullptr ? value : "";
    while (!rest.empty()) {
        const auto pattern = rest.substr(0, rest.find(':'));
        if (!pattern.empty()) {
            patterns.emplace_back(pattern);
        }
        rest.remove_prefix(std::min(rest.size(), pattern.size() + 1));
    }
    return patterns;
}

asio::awaitable<void> find_lidars(
    asio::any_io_executor executor,
    std::shared_ptr<spdlog::logger> log,
    const gateway::LidarMemory& memory,
    LidarChoice& choice
) {
    const auto there = link::look_around(choice.patterns, links_of(choice.lidars));
    const auto plan = link::plan_discovery(there);
    for (const auto& [path, why] : plan.skipped) {
        log->info("not looking at {}: {}", path, why);
    }
    const auto hints = [&memory](const std::string& path) { return memory.baud_hints(path); };
    const auto found = co_await device::discover(executor, plan.look_at, hints, log);
    // The gateway finds these itself: taken here as well, one would be there twice, the second time
    // at a port that is not.
    const auto absent = known_but_absent(choice.lidars, memory);
    for (const auto& [path, serial, baud] : found) {
        if (const auto known = absent.find(serial); known != absent.end()) {
            log->info(
                "{}: this is the lidar of --lidar {}, which is not there",
                path,
                known->second
            );
            continue;
        }
        gateway::LidarUrl lidar{path, link::LinkUrl{path, link::SerialPlace{path, std::nullopt}}};
        lidar.is_found = true;
        lidar.baud_hint = baud;
        choice.lidars.push_back(std::move(lidar));
    }
}

void stand_in_for_none(LidarChoice& choice, spdlog::logger& log) {
    if (!choice.lidars.empty()) {
        return;
    }
    log.warn(
        "no lidar found: starting a virtual one, until one is plugged in. Or name its port with "
        "--lidar, e.g. --lidar /dev/ttyUSB0"
    );
    auto& stand_in = choice.lidars.emplace_back(*gateway::parse_lidar_url(default_virtual));
    stand_in.is_stand_in = true;
}

}  // namespace sweepcast::cli
