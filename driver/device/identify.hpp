// Asks a device who and how it is, and what it can do.
#pragma once

#include "driver/device/conversation.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <vector>

namespace sweepcast::device {

struct Identity {
    protocol::DeviceInfo info;
    protocol::Health health;
    std::vector<ScanMode> modes;
};

/// Ends whatever the device is doing, then asks for its info, health and sample rates
/// (order: protocol.md 4.6). A device that does not know a question gets the documented default.
/// Errors: errc::no_answer if it does not tell who it is; those of the link.
boost::asio::awaitable<Result<Identity>> identify(Conversation& conversation);

/// Asks for the health alone: is the lidar still there, and well?
/// Errors: errc::no_answer; those of the link.
boost::asio::awaitable<Result<protocol::Health>> ask_health(Conversation& conversation);

}  // namespace sweepcast::device
