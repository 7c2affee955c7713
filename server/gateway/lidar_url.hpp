// Where a lidar is and how it is wanted, as users write it.
#pragma once

#include "driver/link/link_url.hpp"
#include "driver/protocol/result.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace sweepcast::gateway {

/// A virtual lidar that the gateway starts itself, on a pseudo terminal of its own.
struct VirtualLidarUrl {
    std::string model{};
    std::string world{};  ///< file; empty: the built-in room
    // As `sweepcast virtual` takes them:
    std::vector<std::string> faults{};
    std::vector<std::string> schedule{};
    std::string control{};
};

/// A lidar of another gateway, by its stream over TCP.
struct RemoteLidarUrl {
    std::string host{};
    std::string port{};
    std::string id{};  ///< empty: the only one that the gateway has
};

/// Rotations per second that may be asked for.
inline constexpr double slowest_hz = 1;
inline constexpr double fastest_hz = 30;

/// For how long a lidar may be told to turn when nobody watches.
inline constexpr std::chrono::seconds longest_patience{std::chrono::hours(24)};

struct LidarUrl {
    std::string text;  ///< as the user wrote it
    std::variant<link::LinkUrl, VirtualLidarUrl, RemoteLidarUrl> where;
    std::string name{};          ///< the id it is to have; empty: by its serial number
    std::string mode{};          ///< scan mode by name or id; empty: not asked for
    std::optional<double> hz{};  ///< rotations per second; none: not asked for
    /// How long it turns on when nobody watches; none: always, or as the gateway is told.
    std::optional<std::chrono::seconds> motor_off_after{};
    bool is_found{};                           ///< nobody named it: a lidar answered there
    std::optional<std::uint32_t> baud_hint{};  ///< line speed at which it was just found
    /// Nobody asked for it: it stands in for a lidar that was not found.
    bool is_stand_in{};
};

/// Reads a link's URL (see link::parse_link_url), or "virtual:a1m8", "virtual:a1m8?world=FILE"
/// (also "fault=FAULT", "schedule=TEXT" and "control=PATH"; spaces need not be encoded), or
/// "sweepcast://HOST[:PORT][/ID]" (port 8081), which takes a name only; all others with the
/// parameters that any lidar may have: "name=left" (1 to 64 of A-Z a-z 0-9 . _ -, not only dots),
/// "mode=Boost" (name or id), "hz=7.5" (slowest_hz to fastest_hz), "motor_off_after=30" (seconds, 1
/// to longest_patience). The Problem names what is wrong
/// and shows what can be written.
[[nodiscard]] Result<LidarUrl, Problem> parse_lidar_url(std::string_view text);

/// The name a lidar goes by until it has been identified: the last part of its port's path, its
/// host, "virtual-a1m8", or what it is called at the other gateway.
[[nodiscard]] std::string port_name(const LidarUrl& url);

/// Whether a lidar can be named so.
[[nodiscard]] bool is_lidar_name(std::string_view name);

/// What is wrong with the names that users gave these lidars, if anything: each may be given once.
[[nodiscard]] std::optional<Problem> name_clash(const std::vector<LidarUrl>& lidars);

}  // namespace sweepcast::gateway
