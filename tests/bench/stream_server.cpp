#include "tests/bench/stream_server.hpp"

#include "server/http/http_session.hpp"
#include "server/stream/session.hpp"
#include "server/stream/tcp_transport.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <boost/asio/error.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <spdlog/logger.h>

#include <cstdio>
#include <cstdlib>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

namespace sweepcast::bench {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

constexpr std::size_t most_connections = 20'000;

/// There are no lidars to control.
class NoControl final : public api::LidarControl {
    static Problem none() {
        return {asio::error::make_error_code(asio::error::not_found), "no lidar", ""};
    }
    asio::awaitable<Outcome> start(std::uint32_t, std::string) override { co_return none(); }
    asio::awaitable<Outcome> stop(std::uint32_t) override { co_return none(); }
    asio::awaitable<Outcome> reset(std::uint32_t) override { co_return none(); }
    asio::awaitable<Outcome> update(std::uint32_t, api::LidarUpdate) override { co_return none(); }
    asio::awaitable<Result<device::Diagnosis, Problem>> diagnose(std::uint32_t) override {
        co_return none();
    }
};

void give_up(std::exception_ptr failure) {
    try {
        std::rethrow_exception(std::move(failure));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "a task failed: %s\n", e.what());
        std::abort();
    }
}

asio::awaitable<void> serve_tcp(
    tcp::socket socket,
    hub::LocalHub& hub,
    hub::MailboxLimits mailbox,
    std::shared_ptr<spdlog::logger> log
) {
    stream::SessionSettings settings{"tcp client", std::nullopt, mailbox};
    const auto transport = stream::make_tcp_transport(std::move(socket));
    co_await stream::serve_subscriber(*transport, hub, std::move(settings), std::move(log));
}

std::unique_ptr<net::Listener> listen(
    net::Workers& workers,
    net::Listener::Serve serve,
    const std::shared_ptr<spdlog::logger>& log
) {
    const tcp::endpoint any_port(asio::ip::address_v4::loopback(), 0);
    auto opened = net::Listener::open(any_port, workers, most_connections, std::move(serve), log);
    if (!opened) {
        throw std::runtime_error(opened.error().cause);
    }
    return std::move(*opened);
}

}  // namespace

frame::WireMessagePtr make_frame(std::uint64_t sequence, std::size_t size) {
    static const std::string noise = [] {
        std::mt19937 random(1);  // NOLINT(cert-msc51-cpp): the same bytes in every run
        std::string bytes(1U << 20U, '\0');
        for (auto& byte : bytes) {
            byte = static_cast<char>(random());
        }
        return bytes;
    }();
    v1::ServerMessage message;
    message.mutable_frame()->set_lidar("bench");
    message.mutable_frame()->set_sequence(sequence);
    for (std::size_t body = size; message.ByteSizeLong() != size && body + 64 > size; --body) {
        message.mutable_frame()->set_body(noise.substr(0, body));
    }
    return std::make_shared<const frame::WireMessage>(message);
}

StreamServer::StreamServer(std::size_t workers, hub::MailboxLimits mailbox)
    : control_(std::make_unique<NoControl>()) {
    std::vector<hub::Hub::Executor> executors;
    for (std::size_t i = 0; i < workers; ++i) {
        workers_.push_back(std::make_unique<async::Worker>("bench", give_up));
        executors.push_back(workers_.back()->executor());
    }
    hub_ = std::make_unique<hub::Hub>(executors);
    for (std::size_t i = 0; i < workers; ++i) {
        apis_.emplace_back(hub_->local(i), *control_);
    }
    const auto log = std::make_shared<spdlog::logger>("bench");  // writes nowhere
    http_ = listen(
        workers_,
        [this, mailbox, log](tcp::socket socket, std::size_t worker) {
            return http::serve_http(
                std::move(socket),
                {apis_[worker], hub_->local(worker), host_names_, mailbox, log}
            );
        },
        log
    );
    tcp_ = listen(
        workers_,
        [this, mailbox, log](tcp::socket socket, std::size_t worker) {
            return serve_tcp(std::move(socket), hub_->local(worker), mailbox, log);
        },
        log
    );
    http_->start();
    tcp_->start();
}

StreamServer::~StreamServer() {
    http_->close();
    tcp_->close();
    for (auto& worker : workers_) {
        worker->stop();
    }
    http_.reset();
    tcp_.reset();
    workers_.clear();
}

void StreamServer::publish(const frame::WireMessagePtr& frame) {
    hub::SweepNews news;
    news.lidar = 1;
    for (auto& variant : hub_->variants().wanted(news.lidar)) {
        news.frames.push_back({std::move(variant), frame});
    }
    hub_->publish(std::move(news));
}

std::uint32_t StreamServer::subscribers() {
    return hub_->local(0).subscribers();
}

}  // namespace sweepcast::bench
