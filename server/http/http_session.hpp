// One HTTP connection: reads requests, has them answered, and hands WebSocket upgrades to the
// stream.
#pragma once

#include "server/api/api.hpp"
#include "server/http/host_names.hpp"
#include "server/hub/local_hub.hpp"
#include "server/hub/mailbox.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <spdlog/logger.h>

#include <memory>

namespace sweepcast::http {

/// What a connection needs of its worker.
struct HttpContext {
    const api::Api& api;
    hub::LocalHub& hub;
    const HostNames& hosts;
    hub::MailboxLimits mailbox;
    std::shared_ptr<spdlog::logger> log;
};

/// Serves one connection to its end. Limits: 16 kB of header, 64 kB of body; 30 s until the first
/// request has been read, 60 s from a response until the next request has been read; 30 s for the
/// client to take a response. A command has no limit here: the device bounds it. A WebSocket has
/// deadlines of its own. Requests to a name that the gateway does not have are refused.
boost::asio::awaitable<void> serve_http(boost::asio::ip::tcp::socket socket, HttpContext context);

}  // namespace sweepcast::http
