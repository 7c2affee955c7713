#include "server/stream/tcp_transport.hpp"

#include "server/frame/message_framing.hpp"
#include "server/stream/messages.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <array>
#include <chrono>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <utility>

namespace sweepcast::stream {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

constexpr int kernel_send_buffer = 128 * 1024;
/// The kernel's clock for data that the peer does not take (zero window included).
constexpr unsigned stall_limit_ms = 120'000;
constexpr std::chrono::milliseconds farewell_limit{500};
constexpr int keepalive_idle_s = 30;
constexpr int keepalive_interval_s = 10;

using KeepaliveIdle = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_KEEPIDLE>;
using KeepaliveInterval = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_KEEPINTVL>;
using UserTimeout = asio::detail::socket_option::integer<IPPROTO_TCP, TCP_USER_TIMEOUT>;

class TcpTransport final : public Transport {
public:
    explicit TcpTransport(tcp::socket socket)
        : outbox_(std::move(socket), frame::Framing::delimited) {
        set_stream_options(outbox_.socket());
    }

    hub::Outbox& outbox() override { return outbox_; }

    asio::awaitable<Result<std::string>> receive() override {
        for (;;) {
            auto message = reader_.next();
            if (!message) {
                co_return message.error();
            }
            if (*message) {
                co_return std::string((*message)->begin(), (*message)->end());
            }
            std::array<std::uint8_t, 128> chunk{};  // a Subscribe fits; every client keeps it
            const auto [failed, got] = co_await outbox_.socket().async_read_some(
                asio::buffer(chunk),
                asio::as_tuple(asio::use_awaitable)
            );
            if (failed) {
                co_return failed;
            }
            reader_.push(std::span(chunk).first(got));
        }
    }

    asio::awaitable<void> close(const std::string&) override {
        using namespace asio::experimental::awaitable_operators;
        error_code ignored;  // the peer may have gone already
        outbox_.socket().shutdown(tcp::socket::shutdown_send, ignored);
        // Closing with bytes unread would make the kernel throw away what we sent last.
        asio::steady_timer limit(outbox_.socket().get_executor(), farewell_limit);
        co_await (drain() || limit.async_wait(asio::use_awaitable));
    }

private:
    asio::awaitable<void> drain() {
        std::array<std::uint8_t, 1024> discarded{};
        for (error_code ended; !ended;) {
            co_await outbox_.socket().async_read_some(
                asio::buffer(discarded),
                asio::redirect_error(asio::use_awaitable, ended)
            );
        }
    }

    hub::Outbox outbox_;
    frame::DelimitedReader reader_{longest_client_message};
};

}  // namespace

void set_stream_options(tcp::socket& socket) {
    error_code ignored;  // an option the kernel refuses costs comfort, not correctness
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(asio::socket_base::send_buffer_size(kernel_send_buffer), ignored);
    socket.set_option(asio::socket_base::keep_alive(true), ignored);
    socket.set_option(KeepaliveIdle(keepalive_idle_s), ignored);
    socket.set_option(KeepaliveInterval(keepalive_interval_s), ignored);
    socket.set_option(UserTimeout(stall_limit_ms), ignored);
}

std::unique_ptr<Transport> make_tcp_transport(tcp::socket socket) {
    return std::make_unique<TcpTransport>(std::move(socket));
}

}  // namespace sweepcast::stream
