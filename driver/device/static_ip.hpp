// The address that a lidar with a network port keeps for itself.
#pragma once

#include "driver/device/conversation.hpp"
#include "driver/protocol/lidar_conf.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

namespace sweepcast::device {

/// Asks for the address; no scan may be running. It is the one that was set last: the lidar goes by
/// it from its next start on. Source: protocol.md 3.
/// Errors: protocol::errc::conf_not_supported if the lidar has none, by its own word or by silence;
/// length_out_of_range; those of the link.
boost::asio::awaitable<Result<protocol::StaticIp>> read_static_ip(Conversation& talk);

/// Sets the address. What the lidar made of it, read_static_ip() tells.
/// Errors: errc::no_answer, after which it may be set or not; protocol::errc::conf_refused; others
/// of decode_set_conf(); those of the link.
boost::asio::awaitable<Result<void>>
set_static_ip(Conversation& talk, const protocol::StaticIp& address);

}  // namespace sweepcast::device
