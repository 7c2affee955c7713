// Listener: accepts TCP connections and spreads them over the workers.
#pragma once

#include "driver/async/worker.hpp"
#include "driver/protocol/result.hpp"
#include "server/net/once_per_second.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <spdlog/logger.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace sweepcast::net {

using Workers = std::vector<std::unique_ptr<async::Worker>>;

/// One listening socket. Accepts on the first worker; each connection then lives on one worker for
/// its whole life, in that worker's task group.
class Listener {
public:
    /// What to do with a connection, on the worker with this index.
    using Serve = std::function<
        boost::asio::awaitable<void>(boost::asio::ip::tcp::socket, std::size_t worker)>;

    /// Opens the socket; start() begins to accept.
    /// The Problem says why it cannot be had, e.g. that the port is in use.
    static Result<std::unique_ptr<Listener>, Problem> open(
        const boost::asio::ip::tcp::endpoint& endpoint,
        Workers& workers,
        std::size_t max_connections,
        Serve serve,
        std::shared_ptr<spdlog::logger> log
    );

    /// Begins to accept. The listener must live until the workers have stopped.
    void start();

    /// Accepts no more. From any thread.
    void close();

    /// Where it listens; the port is the real one.
    [[nodiscard]] boost::asio::ip::tcp::endpoint endpoint() const { return endpoint_; }

private:
    Listener(
        boost::asio::ip::tcp::acceptor acceptor,
        Workers& workers,
        std::size_t max_connections,
        Serve serve,
        std::shared_ptr<spdlog::logger> log
    );
    boost::asio::awaitable<void> accept();
    boost::asio::awaitable<void>
    serve_counted(boost::asio::ip::tcp::socket socket, std::size_t worker);

    boost::asio::ip::tcp::acceptor acceptor_;
    boost::asio::ip::tcp::endpoint endpoint_;
    Workers& workers_;
    std::size_t max_connections_;
    Serve serve_;
    std::shared_ptr<spdlog::logger> log_;
    OncePerSecond failures_;
    OncePerSecond refusals_;
    /// Shared with the connections: those still open when the threads stop are destroyed after this
    /// object.
    std::shared_ptr<std::atomic<std::size_t>> connections_;
};

}  // namespace sweepcast::net
