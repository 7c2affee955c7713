#include "server/client/client.hpp"

#include "server/client/known_lidars.hpp"
#include "server/client/missed_frames.hpp"
#include "server/client/stream_client.hpp"
#include "server/frame/dictionary.hpp"
#include "server/frame/frame_decoder.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <string>
#include <utility>

namespace sweepcast::client {

namespace asio = boost::asio;
using Clock = std::chrono::steady_clock;
using namespace asio::experimental::awaitable_operators;

namespace {

constexpr std::uint32_t spoken_version = 1;
/// As many as make the wait the longest, and more.
constexpr std::uint32_t most_failures = 1000;

/// What is wrong if a connection ends by `failed`.
Problem ended_by(const error_code& failed, const std::string& reason) {
    if (!reason.empty()) {
        return {failed, "the gateway ends the connection: " + reason, ""};
    }
    return {failed, "the connection ended: " + failed.message(), ""};
}

Problem no_gateway(const error_code& failed, const StreamUrl& url) {
    return {
        failed,
        fmt::format("{}:{} does not greet as a gateway's stream does", url.url_host(), url.port),
        "check the port: usually tcp://HOST:8081, or ws://HOST:8080 for HTTP's"};
}

Problem beyond_bounds(const StreamUrl& url) {
    return {
        make_error_code(boost::system::errc::value_too_large),
        fmt::format(
            "{}:{} has more than {} lidars, or lidars with names longer than {} bytes or with "
            "states "
            "larger than {} kB; this program ignores those",
            url.url_host(),
            url.port,
            most_lidars,
            longest_lidar_name,
            most_lidar_memory / 1024
        ),
        "check the address; to receive a lidar that is ignored, subscribe to it by its id"};
}

/// Shortens what a gateway says to longest_text bytes, at the end of a character.
void shorten(std::string& text) {
    if (text.size() > longest_text) {
        auto end = longest_text;
        while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
            --end;
        }
        text = text.substr(0, end);
    }
}

Event shortened(v1::StreamError refusal) {
    shorten(*refusal.mutable_message());
    shorten(*refusal.mutable_hint());
    return refusal;
}

Problem cancelled_by_user() {
    return {make_error_code(asio::error::operation_aborted), "cancelled", ""};
}

}  // namespace

struct Client::Impl {
    Impl(asio::any_io_executor executor, StreamUrl where, ClientOptions how)
        : url(std::move(where))
        , options(std::move(how))
        , wish(options.wish)
        , wait(executor) {}

    asio::awaitable<Result<Event, Problem>> connect();
    asio::awaitable<Result<v1::Hello, Problem>> open();
    asio::awaitable<bool> wait_for_turn();
    asio::awaitable<void> send_wish();
    asio::awaitable<Result<Event, Problem>> receive();

    Result<Event, Problem> lost(Problem why);
    Result<std::optional<Event>, Problem> take(const v1::ServerMessage& message);
    Result<std::optional<Event>, Problem> take(const v1::Frame& frame);
    std::optional<Event> leave_out(std::uint64_t how_many);
    bool brings_refused_lidar(const v1::ServerMessage& message);

    StreamUrl url;
    ClientOptions options;
    std::optional<v1::Subscribe> wish;
    std::shared_ptr<StreamClient> connection;  ///< null: not connected
    frame::FrameDecoder decoder;
    KnownLidars known;
    MissedFrames missed;
    std::uint64_t left_out{};
    bool left_out_told{};      ///< of this connection
    std::optional<Event> due;  ///< what next() gives before it receives more
    asio::steady_timer wait;   ///< until the next attempt, or for cancel() during one
    std::minstd_rand random{std::random_device{}()};
    std::optional<Clock::time_point> connected_at;
    Clock::time_point next_try;
    std::uint32_t failures{};
    std::uint64_t bytes_before{};  ///< of connections that are gone
    std::string closing;           ///< why the gateway is about to close the connection
    std::string refused_lidar;     ///< that the wish waits for
    std::optional<Problem> given_up;
    bool wish_was_set{};  ///< by set_wish()
    bool ever_connected{};
    bool cancelled{};
    bool sending{};
    bool unsent{};
};

Client::Client(asio::any_io_executor executor, StreamUrl url, ClientOptions options)
    : impl_(std::make_unique<Impl>(std::move(executor), std::move(url), std::move(options))) {}

Client::~Client() = default;

asio::awaitable<Result<Event, Problem>> Client::next() {
    if (impl_->cancelled) {
        co_return cancelled_by_user();
    }
    if (impl_->connection) {
        co_return co_await impl_->receive();
    }
    co_return co_await impl_->connect();
}

asio::awaitable<void> Client::set_wish(std::optional<v1::Subscribe> wish) {
    impl_->wish = std::move(wish);
    impl_->wish_was_set = true;
    impl_->refused_lidar.clear();
    co_await impl_->send_wish();
}

void Client::give_up(Problem why) {
    if (impl_->connection) {
        impl_->given_up = std::move(why);
        impl_->connection->close();
    }
}

void Client::cancel() {
    impl_->cancelled = true;
    impl_->wait.cancel();
    if (impl_->connection) {
        impl_->connection->close();
    }
}

std::uint64_t Client::left_out() const {
    return impl_->left_out;
}

std::uint64_t Client::bytes_received() const {
    return impl_->bytes_before + (impl_->connection ? impl_->connection->bytes_received() : 0);
}

/// Waits until it is time for an attempt. False if cancelled.
asio::awaitable<bool> Client::Impl::wait_for_turn() {
    if (failures > 0) {
        wait.expires_at(next_try);
        (void)co_await wait.async_wait(asio::as_tuple(asio::use_awaitable));  // or cancelled
    }
    co_return !cancelled;
}

asio::awaitable<Result<Event, Problem>> Client::Impl::connect() {
    const bool goes_on = co_await wait_for_turn();
    if (!goes_on) {
        co_return cancelled_by_user();
    }
    wait.expires_at(Clock::time_point::max());
    auto outcome = co_await (open() || wait.async_wait(asio::as_tuple(asio::use_awaitable)));
    if (cancelled) {
        co_return cancelled_by_user();
    }
    auto opened = std::get<0>(std::move(outcome));
    if (!opened) {
        co_return lost(opened.error());
    }
    connected_at = Clock::now();
    ever_connected = true;
    co_await send_wish();
    co_return Event(Connected{std::move(*opened)});
}

/// Connects and hears the greeting.
asio::awaitable<Result<v1::Hello, Problem>> Client::Impl::open() {
    auto opened = co_await StreamClient::connect(url, options.connect_limit);
    if (!opened) {
        co_return opened.error();
    }
    connection = std::move(*opened);
    closing.clear();
    refused_lidar.clear();
    missed = {};
    left_out_told = false;
    due.reset();
    asio::steady_timer deadline(wait.get_executor(), options.connect_limit);
    auto outcome = co_await (
        connection->receive() || deadline.async_wait(asio::as_tuple(asio::use_awaitable))
    );
    if (outcome.index() != 0) {
        co_return no_gateway(asio::error::timed_out, url);
    }
    const auto& message = std::get<0>(outcome);
    if (!message) {
        co_return no_gateway(message.error(), url);
    }
    if ((*message)->has_closing()) {
        co_return ended_by({}, (*message)->closing().reason());
    }
    if (!(*message)->has_hello()) {
        co_return no_gateway(make_error_code(boost::system::errc::protocol_error), url);
    }
    auto hello = (*message)->hello();
    if (hello.protocol_version() != spoken_version) {
        co_return Problem{
            make_error_code(boost::system::errc::protocol_not_supported),
            fmt::format("the gateway speaks version {} of the stream", hello.protocol_version()),
            fmt::format("this program speaks version {}: update the older one", spoken_version)};
    }
    due = leave_out(known.begin(hello));
    co_return hello;
}

/// Sends the wish. Only one is on its way at a time: what is set meanwhile follows.
asio::awaitable<void> Client::Impl::send_wish() {
    unsent = true;
    if (std::exchange(sending, true)) {
        co_return;
    }
    while (connection && std::exchange(unsent, false)) {
        const auto to = connection;
        Result<void> sent;
        if (wish) {
            v1::Subscribe now = *wish;
            if (now.dictionaries().empty()) {
                now.add_dictionaries(frame::dictionary_id());
            }
            sent = co_await to->subscribe(now);
        } else if (wish_was_set) {  // else the URL's query has said it all
            sent = co_await to->unsubscribe();
        }
        if (!sent) {
            to->close();  // which receive() tells
        }
    }
    sending = false;
}

asio::awaitable<Result<Event, Problem>> Client::Impl::receive() {
    if (auto event = std::exchange(due, std::nullopt)) {
        co_return std::move(*event);
    }
    for (;;) {
        const auto from = connection;
        const auto message = co_await from->receive();
        if (cancelled) {
            co_return cancelled_by_user();
        }
        if (!message) {
            co_return lost(given_up ? *given_up : ended_by(message.error(), closing));
        }
        auto event = take(**message);
        if (!event) {
            co_return lost(event.error());
        }
        if (brings_refused_lidar(**message)) {
            co_await send_wish();
        }
        if (*event) {
            co_return std::move(**event);
        }
    }
}

/// Gives the connection up.
Result<Event, Problem> Client::Impl::lost(Problem why) {
    if (connection) {
        bytes_before += connection->bytes_received();
        connection->close();
        connection.reset();
    }
    if (options.reconnect == Reconnect::never ||
        (options.reconnect == Reconnect::once_connected && !ever_connected)) {
        return why;
    }
    // One that came and went at once is a failure as well.
    const bool had_held = connected_at && Clock::now() - *connected_at > options.backoff.longest;
    connected_at.reset();
    failures = had_held ? 1 : std::min(failures + 1, most_failures);
    if (std::exchange(given_up, std::nullopt)) {
        failures = most_failures;
    }
    const double luck = std::uniform_real_distribution<double>(0, 1)(random);
    const auto retry_in = async::wait_after(failures, options.backoff, luck);
    next_try = Clock::now() + retry_in;
    return Event(Disconnected{std::move(why), retry_in});
}

Result<std::optional<Event>, Problem> Client::Impl::take(const v1::ServerMessage& message) {
    switch (message.message_case()) {
    case v1::ServerMessage::kLidar:
        return known.admit(message.lidar()) ? std::optional<Event>(message.lidar()) : leave_out(1);
    case v1::ServerMessage::kFrame:
        return take(message.frame());
    case v1::ServerMessage::kStats:
        return std::optional<Event>(message.stats());
    case v1::ServerMessage::kSubscribed:
        // The frames before it were of the wish before, and are no measure for those after it.
        missed = {};
        return std::optional<Event>(message.subscribed());
    case v1::ServerMessage::kError:
        if (message.error().code() == "lidar_not_found" && wish) {
            refused_lidar = wish->lidar();
        }
        return std::optional<Event>(shortened(message.error()));
    case v1::ServerMessage::kClosing:
        closing = message.closing().reason();
        shorten(closing);
        break;
    case v1::ServerMessage::kHello:
    case v1::ServerMessage::MESSAGE_NOT_SET:
        break;  // of a newer gateway: nothing for us
    }
    return std::optional<Event>{};
}

Result<std::optional<Event>, Problem> Client::Impl::take(const v1::Frame& frame) {
    const auto missed_before = missed.before(frame);
    if (!missed_before) {
        return leave_out(1);
    }
    auto decoded = decoder.decode(frame);
    if (!decoded) {
        return Problem{
            decoded.error(),
            "a frame does not decode: " + decoded.error().message(),
            "is the gateway of another version?"};
    }
    Scan scan;
    scan.lidar = frame.lidar();
    scan.sequence = frame.sequence();
    scan.kind = frame.kind();
    scan.sector = frame.sector();
    scan.last = frame.last();
    scan.omitted = frame.omitted();
    scan.missed = *missed_before;
    scan.wire_bytes = frame.ByteSizeLong();
    scan.scan = std::move(*decoded);
    return std::optional<Event>(std::move(scan));
}

/// Counts what is left out, and gives the event that tells of it, the first time in a connection.
std::optional<Event> Client::Impl::leave_out(std::uint64_t how_many) {
    left_out += how_many;
    if (how_many == 0 || std::exchange(left_out_told, true)) {
        return std::nullopt;
    }
    return LeftOut{beyond_bounds(url)};
}

/// Whether the lidar is there now that a wish was refused for.
bool Client::Impl::brings_refused_lidar(const v1::ServerMessage& message) {
    if (!message.has_lidar() || refused_lidar.empty() || message.lidar().id() != refused_lidar) {
        return false;
    }
    refused_lidar.clear();
    return true;
}

}  // namespace sweepcast::client
