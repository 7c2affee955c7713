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

constexpr std::chrono::seconds between_stats{1};

/// Tells a slow client what it missed, at most once a second.
class DropNews {
public:
    [[nodiscard]] bool due(const hub::MailboxCounts& counts, Clock::time_point now) {
        if (counts.frames_dropped == told_ || now - last_ < between_stats) {
            return false;
        }
        told_ = counts.frames_dropped;
        last_ = now;
        return true;
    }

private:
    std::uint64_t told_{};
    Clock::time_point last_{};
};

/// Sends what the mailbox holds. Returns why it ended.
asio::awaitable<std::string> deliver(Transport& transport, hub::Mailbox& mailbox) {
    DropNews drop_news;
    for (;;) {
        const auto message = co_await mailbox.next();
        if (!message) {
            // While the other half still reads: a WebSocket's farewell wants an answer.
            co_await transport.close(mailbox.close_reason());
            co_return mailbox.close_reason();
        }
        auto sent = co_await transport.send(*message);
        if (sent && drop_news.due(mailbox.counts(), Clock::now())) {
            const auto stats = stats_message(mailbox.counts());
            sent = co_await transport.send(*stats);
        }
        if (!sent) {
            co_return sent.error().message();
        }
    }
}

asio::awaitable<void> until_cancelled() {
    asio::steady_timer never(co_await asio::this_coro::executor, Clock::time_point::max());
    co_await never.async_wait(asio::use_awaitable);
}

/// Hears what the client wants. Returns why it ended.
asio::awaitable<std::string> listen(
    Transport& transport,
    hub::LocalHub& hub,
    hub::LocalHub::Subscription& subscription,
    hub::Mailbox& mailbox
) {
    for (;;) {
        const auto bytes = co_await transport.receive();
        if (!bytes && bytes.error().category() == frame::frame_category()) {
            // Not our framing: say so before the connection ends, which deliver() sees to.
            const auto reason = bytes.error().message();
            const auto farewell = closing_message(reason);
            mailbox.push_control(farewell);
            mailbox.close(reason);
            co_await until_cancelled();
        }
        if (!bytes) {
            co_return bytes.error().message();
        }
        const auto wish = wish_from_message(*bytes, hub);
        if (wish) {
            subscription.set_wish(*wish);
        } else {
            mailbox.push_control(refusal_message(wish.error()));
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

    const auto executor = co_await asio::this_coro::executor;
    hub::Mailbox mailbox(executor, settings.mailbox);
    mailbox.push_control(hello_message(hub));
    hub::LocalHub::Subscription subscription(hub, mailbox);
    subscription.set_wish(settings.wish);
    log->info("{}: connected", settings.client);

    const auto ended =
        co_await (deliver(transport, mailbox) || listen(transport, hub, subscription, mailbox));
    const auto reason = std::visit([](const std::string& text) { return text; }, ended);
    log->info(
        "{}: left ({}); frames sent {}, dropped {}",
        settings.client,
        reason,
        mailbox.counts().frames_taken,
        mailbox.counts().frames_dropped
    );
}

}  // namespace sweepcast::stream
