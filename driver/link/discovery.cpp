#include "driver/link/discovery.hpp"

#include "driver/link/device_node.hpp"
#include "driver/link/port_holder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glob.h>
#include <map>
#include <set>
#include <sys/stat.h>
#include <system_error>
#include <utility>

namespace sweepcast::link {

namespace fs = std::filesystem;

namespace {

/// The paths that match, sorted; none if there are none or they cannot be read.
std::vector<std::string> expand(const std::string& pattern) {
    struct Matches {
        glob_t found{};
        ~Matches() { ::globfree(&found); }
    } matches;
    if (::glob(pattern.c_str(), GLOB_TILDE, nullptr, &matches.found) != 0) {
        return {};
    }
    return {matches.found.gl_pathv, matches.found.gl_pathv + matches.found.gl_pathc};
}

/// Describes ports; each device file once, for finding out who holds it walks all of `proc`.
class Describer {
public:
    explicit Describer(const fs::path& proc) : proc_(proc) {}

    FoundPort operator()(const std::string& path) {
        const auto node = device_node(path);
        auto known = known_.find(node);
        if (known == known_.end()) {
            known = known_.emplace(node, ask(node)).first;
        }
        auto port = known->second;
        port.path = path;
        return port;
    }

private:
    [[nodiscard]] FoundPort ask(const std::string& node) const {
        FoundPort port{node, node, false, ""};
        std::error_code not_there;
        port.is_device = fs::is_character_file(node, not_there);
        if (port.is_device) {
            const auto holders = find_port_competitors(node, proc_);
            if (!holders.empty()) {
                port.holder =
                    fmt::format("{} (process {})", holders.front().command, holders.front().pid);
            }
        }
        return port;
    }

    const fs::path& proc_;
    std::map<std::string, FoundPort> known_;  ///< by device file
};

FoundPort describe_usb(const SerialPort& usb, Describer& describe) {
    auto port = describe(usb.path);
    port.adapter = fmt::format(
        "{}{}({:04x}:{:04x})",
        usb.product,
        usb.product.empty() ? "" : " ",
        usb.vendor_id,
        usb.product_id
    );
    port.lidar_adapter = is_lidar_adapter(usb.vendor_id, usb.product_id);
    return port;
}

/// Collects a plan, each device file once.
class Planner {
public:
    explicit Planner(const std::vector<std::string>& taken_nodes)
        : taken_(taken_nodes.begin(), taken_nodes.end()) {}

    void consider(const FoundPort& port) {
        if (!seen_.insert(port.node).second) {
            return;  // by another name
        }
        if (taken_.contains(port.node)) {
            skip(port.path, "named by --lidar already");
        } else if (!port.is_device) {
            skip(port.path, "not a device");
        } else if (!port.holder.empty()) {
            skip(port.path, "in use by " + port.holder);
        } else if (plan_.look_at.size() >= most_ports) {
            skip(port.path, fmt::format("no more than {} ports are looked at", most_ports));
        } else {
            plan_.look_at.push_back(port.path);
        }
    }
    void skip(const std::string& path, std::string why) {
        plan_.skipped.push_back({path, std::move(why)});
    }
    [[nodiscard]] bool considered(const FoundPort& port) const { return seen_.contains(port.node); }
    DiscoveryPlan take() { return std::move(plan_); }

private:
    std::set<std::string> taken_;
    std::set<std::string> seen_;
    DiscoveryPlan plan_;
};

}  // namespace

DiscoveryPlan plan_discovery(const PortsThere& there) {
    Planner planner(there.taken_nodes);
    for (const auto& port : there.usb) {
        if (port.lidar_adapter) {
            planner.consider(port);
        }
    }
    for (const auto& [pattern, ports] : there.patterns) {
        if (ports.empty()) {
            planner.skip(pattern, "matches nothing");
        }
        for (const auto& port : ports) {
            planner.consider(port);
        }
    }
    const std::set<std::string> taken(there.taken_nodes.begin(), there.taken_nodes.end());
    for (const auto& port : there.usb) {
        if (!planner.considered(port) && !taken.contains(port.node)) {
            planner.skip(
                port.path,
                fmt::format(
                    "its adapter, {}, is none that RPLIDARs are sold with; --discover {} looks at "
                    "it all the same",
                    port.adapter,
                    port.path
                )
            );
        }
    }
    return planner.take();
}

PortsThere look_around(
    const std::vector<std::string>& patterns,
    const std::vector<LinkUrl>& taken,
    const SystemRoots& roots,
    const fs::path& proc
) {
    PortsThere there;
    Describer describe(proc);
    for (const auto& usb : list_usb_ports(roots)) {
        there.usb.push_back(describe_usb(usb, describe));
    }
    for (const auto& pattern : patterns) {
        PatternMatches matches{pattern, {}};
        for (const auto& path : expand(pattern)) {
            matches.ports.push_back(describe(path));
        }
        there.patterns.push_back(std::move(matches));
    }
    for (const auto& url : taken) {
        there.taken_nodes.push_back(place_key(url));
    }
    return there;
}

std::vector<std::string>
ports_worth_a_look(const std::vector<std::string>& patterns, const SystemRoots& roots) {
    std::vector<std::string> paths;
    std::set<std::string> nodes;
    const auto add = [&](const std::string& path) {
        std::error_code not_there;
        if (paths.size() < most_ports && fs::is_character_file(path, not_there) &&
            nodes.insert(device_node(path)).second) {
            paths.push_back(path);
        }
    };
    for (const auto& usb : list_candidate_ports(roots)) {
        add(usb.path);
    }
    for (const auto& pattern : patterns) {
        for (const auto& path : expand(pattern)) {
            add(path);
        }
    }
    return paths;
}

std::string place_key(const LinkUrl& url) {
    if (const auto* serial = std::get_if<SerialPlace>(&url.where)) {
        return device_node(serial->path);
    }
    if (const auto* tcp = std::get_if<TcpPlace>(&url.where)) {
        return fmt::format("tcp {} {}", tcp->host, tcp->port);
    }
    const auto& udp = std::get<UdpPlace>(url.where);
    return fmt::format("udp {} {}", udp.host, udp.port);
}

}  // namespace sweepcast::link
