#include "server/net/listener.hpp"

#include "server/net/endpoint.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>

#include <chrono>
#include <utility>

namespace sweepcast::net {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;

namespace {

Problem describe(const error_code& failed, const tcp::endpoint& endpoint) {
    auto hint = std::string("choose another address, for example 127.0.0.1:0 for any free port");
    if (failed == asio::error::access_denied) {
        hint = "ports below 1024 need root: choose a higher one";
    } else if (failed == asio::error::address_in_use) {
        hint =
            "another program (or another sweepcast) has it: stop that one or choose another port";
    }
    return {
        failed,
        fmt::format("cannot listen on {}: {}", to_text(endpoint), failed.message()),
        hint};
}

}  // namespace

Result<std::unique_ptr<Listener>, Problem> Listener::open(
    const tcp::endpoint& endpoint,
    Workers& workers,
    std::size_t max_connections,
    Serve serve,
    std::shared_ptr<spdlog::logger> log
) {
    tcp::acceptor acceptor(workers.front()->executor());
    error_code failed;
    acceptor.open(endpoint.protocol(), failed);
    if (!failed) {
        acceptor.set_option(tcp::acceptor::reuse_address(true), failed);
    }
    if (!failed) {
        acceptor.bind(endpoint, failed);
    }
    if (!failed) {
        acceptor.listen(tcp::acceptor::max_listen_connections, failed);
    }
    if (failed) {
        return describe(failed, endpoint);
    }
    return std::unique_ptr<Listener>(new Listener(
        std::move(acceptor),
        workers,
        max_connections,
        std::move(serve),
        std::move(log)
    ));
}

Listener::Listener(
    tcp::acceptor acceptor,
    Workers& workers,
    std::size_t max_connections,
    Serve serve,
    std::shared_ptr<spdlog::logger> log
)
    : acceptor_(std::move(acceptor))
    , endpoint_(acceptor_.local_endpoint())
    , workers_(workers)
    , max_connections_(max_connections)
    , serve_(std::move(serve))
    , log_(std::move(log))
    , connections_(std::make_shared<std::atomic<std::size_t>>()) {}

void Listener::start() {
    auto& first = *workers_.front();
    asio::post(first.executor(), [this, &first] { first.tasks().spawn(accept()); });
}

void Listener::close() {
    asio::post(acceptor_.get_executor(), [this] {
        error_code ignored;  // closing what is closed already is no failure
        acceptor_.close(ignored);
    });
}

asio::awaitable<void> Listener::accept() {
    for (std::size_t turn = 0; acceptor_.is_open(); ++turn) {
        const auto index = turn % workers_.size();
        auto& worker = *workers_[index];
        auto [failed, socket] =
            co_await acceptor_.async_accept(worker.executor(), asio::as_tuple(asio::use_awaitable));
        if (failed == asio::error::operation_aborted) {
            co_return;
        }
        if (failed) {  // most likely out of descriptors: let some clients leave first
            if (const auto times = failures_.count(std::chrono::steady_clock::now())) {
                log_->warn("cannot accept connections ({} times): {}", *times, failed.message());
            }
            asio::steady_timer pause(acceptor_.get_executor(), 100ms);
            co_await pause.async_wait(asio::use_awaitable);
            continue;
        }
        if (*connections_ >= max_connections_) {
            if (const auto refused = refusals_.count(std::chrono::steady_clock::now())) {
                log_->warn(
                    "connections refused: {}; there are {} already, the most allowed",
                    *refused,
                    max_connections_
                );
            }
            continue;
        }
        ++*connections_;
        // A handler must be copyable for post in 1.81's executors; the socket is not.
        auto handed = std::make_shared<tcp::socket>(std::move(socket));
        asio::post(worker.executor(), [this, &worker, index, handed] {
            worker.tasks().spawn(serve_counted(std::move(*handed), index));
        });
    }
}

asio::awaitable<void> Listener::serve_counted(tcp::socket socket, std::size_t worker) {
    struct Leave {
        std::shared_ptr<std::atomic<std::size_t>> connections;
        ~Leave() { --*connections; }
    } leave{connections_};
    co_await serve_(std::move(socket), worker);
}

}  // namespace sweepcast::net
