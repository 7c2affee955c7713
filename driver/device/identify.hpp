// Asks a device who and how it is, and what it can do.
#pragma once

#include "driver/device/ask.hpp"
#include "driver/device/conversation.hpp"
#include "driver/device/motor_traits.hpp"
#include "driver/device/scan_mode.hpp"
#include "driver/protocol/reply.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <string>
#include <vector>

namespace sweepcast::device {

struct Identity {
    protocol::DeviceInfo info;
    protocol::Health health;
    std::vector<ScanMode> modes;
    /// The name its maker gave this very model, e.g. "A3M1-R1"; empty if it has none.
    std::string alias;
    MotorTraits motor;
};

/// Ends whatever the device is doing, then asks for its info, health, modes and motor (order:
/// protocol.md 4.6). What a device does not know gets the documented default, after a short wait.
/// Errors: errc::no_answer if it does not tell who it is; those of the link.
boost::asio::awaitable<Result<Identity>> identify(Conversation& talk);

/// Asks for the info alone, after STOP: is a lidar there, and which?
/// Errors: errc::no_answer; those of the link.
boost::asio::awaitable<Result<protocol::DeviceInfo>>
ask_info(Conversation& talk, Patience patience = patience_for_answers);

/// Asks for the health alone: is the lidar still there, and well?
/// Errors: errc::no_answer; those of the link.
boost::asio::awaitable<Result<protocol::Health>> ask_health(Conversation& talk);

/// Asks for the alias and the motor, of a lidar whose info and modes are known, and fills them in.
/// What it does not know gets the documented default. Errors: those of the link.
boost::asio::awaitable<Result<void>> ask_details(Conversation& talk, Identity& identity);

/// The name to show: the alias if the lidar has one, else the model's.
[[nodiscard]] std::string shown_name(const Identity& identity);

}  // namespace sweepcast::device
