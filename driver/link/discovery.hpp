// Which ports to look at when lidars are to be found, and why not at others.
#pragma once

#include "driver/link/link_url.hpp"
#include "driver/link/port_list.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace sweepcast::link {

/// A port as it was come across.
struct FoundPort {
    std::string path;       ///< as found or matched; may be a link
    std::string node;       ///< the device file that it leads to
    bool is_device{};       ///< a character device
    std::string holder;     ///< who has it open, e.g. "minicom (process 812)"; empty: nobody seen
    std::string adapter{};  ///< of a USB port: what the adapter is, e.g. "CP2102 (10c4:ea60)"
    bool lidar_adapter{};   ///< RPLIDARs are sold with this adapter
    bool operator==(const FoundPort&) const = default;
};

/// What a pattern of the user's matches, e.g. "/dev/ttyAMA*".
struct PatternMatches {
    std::string pattern;
    std::vector<FoundPort> ports;
    bool operator==(const PatternMatches&) const = default;
};

/// What there is to choose from.
struct PortsThere {
    std::vector<FoundPort> usb;            ///< behind USB adapters of any kind
    std::vector<PatternMatches> patterns;  ///< told by the user
    std::vector<std::string> taken_nodes;  ///< device files of lidars that the user named
};

struct DiscoveryPlan {
    struct Skipped {
        std::string path;  ///< or pattern
        std::string why;
        bool operator==(const Skipped&) const = default;
    };
    std::vector<std::string> look_at;  ///< each device file once, by the name it was found under
    std::vector<Skipped> skipped;
};

/// Bound on a plan: looking at a port takes up to seconds, and a pattern may match anything.
inline constexpr std::size_t most_ports = 64;

/// Chooses the USB ports whose adapters RPLIDARs are sold with, then what the patterns match, told
/// by the user to be worth a look. Left out, each with the reason: what is taken already, in use or
/// no device, and what is behind other adapters. Pure.
DiscoveryPlan plan_discovery(const PortsThere& there);

/// Looks around: sysfs, the patterns (see glob(7), with ~ for a home), who has the ports open.
/// `taken` are the places of lidars that the user named. Opens no port.
PortsThere look_around(
    const std::vector<std::string>& patterns,
    const std::vector<LinkUrl>& taken,
    const SystemRoots& roots = {},
    const std::filesystem::path& proc = "/proc"
);

/// The ports behind USB adapters that RPLIDARs are sold with, and the devices that the patterns
/// match, each device file once and no more than most_ports. Cheap: nobody is asked who has them
/// open.
std::vector<std::string>
ports_worth_a_look(const std::vector<std::string>& patterns, const SystemRoots& roots = {});

/// One text for all names of a place: the device file behind a path, links resolved, or scheme,
/// host and port. Two links of the same key would fight for one device.
std::string place_key(const LinkUrl& url);

}  // namespace sweepcast::link
