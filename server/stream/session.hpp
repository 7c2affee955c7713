// One subscriber's session, the same over every transport: greet, hear what it wants, deliver.
#pragma once

#include "server/hub/local_hub.hpp"
#include "server/hub/mailbox.hpp"
#include "server/stream/messages.hpp"
#include "server/stream/transport.hpp"

#include <boost/asio/awaitable.hpp>
#include <spdlog/logger.h>

#include <memory>
#include <optional>
#include <string>

namespace sweepcast::stream {

struct SessionSettings {
    /// For the log: who this is, e.g. "tcp 127.0.0.1:53214".
    std::string client;
    /// What to deliver without being asked (a WebSocket URL may say so).
    std::optional<Order> order;
    hub::MailboxLimits mailbox{};
};

/// Serves one client until it leaves, errs or is told to go. `hub` is the share of the worker this
/// runs on.
boost::asio::awaitable<void> serve_subscriber(
    Transport& transport,
    hub::LocalHub& hub,
    SessionSettings settings,
    std::shared_ptr<spdlog::logger> log
);

}  // namespace sweepcast::stream
