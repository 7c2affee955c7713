#include "server/stream/session.hpp"

#include "server/frame/error.hpp"
#include "server/stream/messages.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <chrono>
#include <variant>

namespace sweepcast::stream {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;

namespace {

/// Sends what waits for the client, until no more comes. Returns why it ended.
asio::awaitable<std::string> deliver(Transport& transport) {
    auto& outbox = transport.outbox();
    co_await outbox.run();
    if (!outbox.failed()) {
        // While the other half still reads: a WebSocket's farewell wants an answer.
        co_await transport.close(outbox.end_reason());
    }
    co_return outbox.end_reason();
}

asio::awaitable<void> until_cancelled() {
    asio::steady_timer never(co_await asio::this_coro::executor, Clock::time_point::max());
    co_await never.async_wait(asio::use_awaitable);
}

/// Hears what the client wants. Returns why it ended.
asio::awaitable<std::string>
listen(Transport& transport, hub::LocalHub& hub, hub::LocalHub::Subscription& subscription) {
    auto& outbox = transport.outbox();
    for (;;) {
        const auto bytes = co_await transport.receive();
        if (!bytes && bytes.error().category() == frame::frame_category()) {
            // Not our framing: say so before the connection ends, which deliver() sees to.
            const auto reason = bytes.error().message();
            const auto farewell = closing_message(reason);
            outbox.push_control(farewell);
            outbox.close(reason);
            co_await until_cancelled();
        }
        if (!bytes) {
            co_return bytes.error().message();
        }
        const auto wish = wish_from_message(*bytes, hub);
        if (wish) {
            subscription.set_wish(*wish);
        } else {
            outbox.push_control(refusal_message(wish.error()));
        }
    }
}

}  // namespace

asio::awaitable<void> serve_subscriber(
    Transport& transport,
    hub::LocalHub& hub,
    SessionSettings settings,
    std::shared_ptr<spdlog::logger> log
) {
    using namespace asio::experimental::awaitable_operators;

    auto& outbox = transport.outbox();
    outbox.set_up(settings.mailbox, stats_message);
    outbox.push_control(hello_message(hub));
    hub::LocalHub::Subscription subscription(hub, outbox);
    subscription.set_wish(settings.wish);
    log->info("{}: connected", settings.client);

    const auto ended = co_await (deliver(transport) || listen(transport, hub, subscription));
    const auto reason = std::visit([](const std::string& text) { return text; }, ended);
    log->info(
        "{}: left ({}); frames sent {}, dropped {}",
        settings.client,
        reason,
        outbox.counts().frames_sent,
        outbox.counts().frames_dropped
    );
}

}  // namespace sweepcast::stream
