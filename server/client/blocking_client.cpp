#include "server/client/blocking_client.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/use_future.hpp>

#include <future>
#include <utility>

namespace sweepcast::client {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

struct BlockingClient::Impl {
    Impl(StreamUrl url, ClientOptions options)
        : client(context.get_executor(), std::move(url), std::move(options)) {}

    static bool is_ready(const std::future<Result<Event, Problem>>& event) {
        return event.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }

    void ask_for_next() {
        if (!pending.valid()) {
            pending = asio::co_spawn(context, client.next(), asio::use_future);
        }
        context.restart();
    }

    asio::io_context context{1};
    Client client;
    std::future<Result<Event, Problem>> pending;  ///< that a limited wait left behind
};

BlockingClient::BlockingClient(StreamUrl url, ClientOptions options)
    : impl_(std::make_unique<Impl>(std::move(url), std::move(options))) {}

BlockingClient::~BlockingClient() {
    impl_->client.cancel();
    impl_->context.restart();
    impl_->context.run();  // ends a next() that was left behind
}

Result<Event, Problem> BlockingClient::next() {
    impl_->ask_for_next();
    while (!Impl::is_ready(impl_->pending)) {
        impl_->context.run_one();
    }
    return impl_->pending.get();
}

Result<std::optional<Event>, Problem> BlockingClient::next(std::chrono::milliseconds limit) {
    impl_->ask_for_next();
    const auto deadline = Clock::now() + limit;
    while (!Impl::is_ready(impl_->pending)) {
        if (impl_->context.run_one_until(deadline) == 0) {
            return std::optional<Event>{};
        }
    }
    auto event = impl_->pending.get();
    if (!event) {
        return event.error();
    }
    return std::optional<Event>(std::move(*event));
}

void BlockingClient::set_wish(std::optional<v1::Subscribe> wish) {
    auto sent =
        asio::co_spawn(impl_->context, impl_->client.set_wish(std::move(wish)), asio::use_future);
    impl_->context.restart();
    while (sent.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
        impl_->context.run_one();
    }
    sent.get();
}

void BlockingClient::cancel() {
    asio::post(impl_->context, [this] { impl_->client.cancel(); });
}

}  // namespace sweepcast::client
