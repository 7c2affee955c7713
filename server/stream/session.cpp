#include "server/stream/session.hpp"

#include "driver/async/task_group.hpp"
#include "server/frame/error.hpp"
#include "server/stream/messages.hpp"

#include <boost/asio/error.hpp>
#include <boost/asio/this_coro.hpp>

#include <chrono>
#include <exception>
#include <utility>

namespace sweepcast::stream {

namespace asio = boost::asio;

namespace {

/// Long enough for any client that still takes something: the kernel cuts off the others.
constexpr std::chrono::hours no_limit{24};

/// What the outbox cannot do at once: sends what waits, and ends the connection once it is closed.
asio::awaitable<void> attend(Transport& transport) {
    auto& outbox = transport.outbox();
    co_await outbox.run();
    if (outbox.is_finished()) {
        // While the other half still reads: a WebSocket's farewell wants an answer.
        co_await transport.close(outbox.end_reason());
        outbox.abort(asio::error::operation_aborted);  // and then the other half ends too
    }
}

/// Delivers what is asked for from now on, or says why not.
void obey(const Order& order, hub::LocalHub::Subscription& subscription, hub::Outbox& outbox) {
    if (!subscription.set_wish(order.wish, order.answer)) {
        outbox.push_control(refusal_message(too_many_wishes(order.request)));
    }
}

/// Hears what the client wants. Returns why it ended.
asio::awaitable<std::string> listen(
    Transport& transport,
    hub::LocalHub& hub,
    hub::LocalHub::Subscription& subscription,
    async::TaskGroup& attendants
) {
    auto& outbox = transport.outbox();
    for (;;) {
        const auto bytes = co_await transport.receive();
        if (!bytes && bytes.error().category() == frame::frame_category()) {
            // Not our framing: say so before the connection ends, which attend() sees to.
            const auto reason = bytes.error().message();
            const auto farewell = closing_message(reason);
            outbox.push_control(farewell);
            outbox.close(reason);
            co_await attendants.join(no_limit);
            co_return reason;
        }
        if (!bytes) {
            co_return bytes.error().message();
        }
        const auto order = order_from_message(*bytes, hub);
        if (order) {
            obey(*order, subscription, outbox);
        } else {
            outbox.push_control(refusal_message(order.error()));
        }
    }
}

/// Serves the client while it is there. Returns why it ended.
asio::awaitable<std::string> talk(
    Transport& transport,
    hub::LocalHub& hub,
    const SessionSettings& settings,
    async::TaskGroup& attendants
) {
    auto& outbox = transport.outbox();
    outbox.push_control(hello_message(hub));
    hub::LocalHub::Subscription subscription(hub, outbox);
    if (settings.order) {
        obey(*settings.order, subscription, outbox);
    }
    const auto read_error = co_await listen(transport, hub, subscription, attendants);
    co_return outbox.end_reason().empty() ? read_error : outbox.end_reason();
}

}  // namespace

asio::awaitable<void> serve_subscriber(
    Transport& transport,
    hub::LocalHub& hub,
    SessionSettings settings,
    std::shared_ptr<spdlog::logger> log
) {
    auto& outbox = transport.outbox();
    std::exception_ptr failure;
    async::TaskGroup attendants(
        co_await asio::this_coro::executor,
        [&failure](std::exception_ptr what) { failure = std::move(what); }
    );
    // Nothing waits for most clients at most times: they have one coroutine, which reads.
    outbox.set_up(settings.mailbox, stats_message, [&attendants, &transport] {
        attendants.spawn(attend(transport));
    });
    log->info("{}: connected", settings.client);
    std::string reason = "cancelled";
    try {
        reason = co_await talk(transport, hub, settings, attendants);
    } catch (...) {  // goes on below, once nothing is left that uses the transport
        failure = std::current_exception();
    }
    co_await asio::this_coro::reset_cancellation_state(asio::disable_cancellation());
    outbox.abort(asio::error::operation_aborted);
    attendants.cancel();
    co_await attendants.join(no_limit);
    log->info(
        "{}: left ({}); frames sent {}, dropped {}",
        settings.client,
        reason,
        outbox.counts().frames_sent,
        outbox.counts().frames_dropped
    );
    if (failure) {
        std::rethrow_exception(failure);
    }
}

}  // namespace sweepcast::stream
