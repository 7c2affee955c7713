// Finds out at which line speed a lidar speaks, and talks it into another.
#pragma once

#include "driver/device/conversation.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace sweepcast::device {

/// The line speeds that RPLIDARs come with (protocol.md 6), the most common first.
inline constexpr std::array<std::uint32_t, 4> usual_bauds{115200, 256000, 460800, 1000000};

/// The usual speeds with `hints` in front, each once: where to look first.
[[nodiscard]] std::vector<std::uint32_t> bauds_to_try(std::span<const std::uint32_t> hints);

/// A lidar, and the speed at which it answered.
struct Found {
    std::uint32_t baud{};
    protocol::DeviceInfo info;
};

/// Ends a scan that may be running and asks who is there at each speed in turn; the line stays at
/// the one at which a lidar answered. Speeds that the adapter cannot run at are passed over. On a
/// network there is no speed to try. Takes at most 0.7 s a speed, at the first one 1.7 s if the
/// lidar was met there before: it may be booting. Errors: errc::no_answer; those of the link,
/// baud_not_supported only if the adapter can run at none of the speeds.
boost::asio::awaitable<Result<Found>>
find_baud(Conversation& talk, std::span<const std::uint32_t> bauds, bool met_before = false);

/// Makes a lidar that answers at the present speed of the line speak at `baud`, and the line with
/// it; it keeps to that until it loses its power. Source: protocol.md 4.7.
/// Errors: errc::baud_refused if it does not follow: it then speaks as before, and so does the
/// line; those of the link.
boost::asio::awaitable<Result<void>> negotiate_baud(Conversation& talk, std::uint32_t baud);

}  // namespace sweepcast::device
