// Asks a lidar which scan modes it has.
#pragma once

#include "driver/device/conversation.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <vector>

namespace sweepcast::device {

/// The scan modes of a lidar that can be decoded here. One that knows GET_LIDAR_CONF lists them,
/// with ids, ranges and the typical one; an older one, or one that does not answer that, has those
/// that GET_SAMPLERATE tells of, and one older still the documented defaults (protocol.md 3, 4.2,
/// 4.4). Errors: those of the link.
boost::asio::awaitable<Result<std::vector<ScanMode>>>
read_modes(Conversation& talk, const protocol::DeviceInfo& info);

}  // namespace sweepcast::device
