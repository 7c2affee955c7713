// OutboxStream: lets Beast's WebSocket read from a client's socket and write through its outbox, so
// that a pong never lands inside a frame that is half sent. For .cpp files only.
#pragma once

#include "server/hub/outbox.hpp"

#include <boost/asio/associated_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/error.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

namespace sweepcast::stream {

/// An AsyncStream (Beast's term) over an outbox, which must outlive it.
class OutboxStream {
public:
    using executor_type = boost::asio::ip::tcp::socket::executor_type;

    /// `unread` is what has already been read from the outbox's socket: it comes first.
    explicit OutboxStream(hub::Outbox& outbox, std::string unread = {})
        : outbox_(&outbox)
        , unread_(std::move(unread)) {}

    [[nodiscard]] executor_type get_executor() { return outbox_->socket().get_executor(); }

    template <class Buffers, class Token>
    auto async_read_some(const Buffers& buffers, Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
            Read{this},
            token,
            buffers
        );
    }

    /// Completes when the bytes have left the outbox: while Beast waits for that it does not read,
    /// so a client that sends pings and does not read is not answered without bound.
    template <class Buffers, class Token>
    auto async_write_some(const Buffers& buffers, Token&& token) {
        return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
            Write{outbox_},
            token,
            first_of(buffers)
        );
    }

    friend void teardown(
        boost::beast::role_type role,
        OutboxStream& stream,
        boost::system::error_code& failed
    ) {
        using boost::beast::websocket::teardown;
        teardown(role, stream.outbox_->socket(), failed);
    }

    template <class Handler>
    friend void
    async_teardown(boost::beast::role_type role, OutboxStream& stream, Handler&& handler) {
        using boost::beast::websocket::async_teardown;
        async_teardown(role, stream.outbox_->socket(), std::forward<Handler>(handler));
    }

    /// Beast's deadlines end here.
    friend void beast_close_socket(OutboxStream& stream) {
        stream.outbox_->abort(boost::beast::error::timeout);
    }

private:
    /// Beast gives a control frame as one buffer.
    template <class Buffers>
    static std::span<const std::uint8_t> first_of(const Buffers& buffers) {
        const auto end = boost::asio::buffer_sequence_end(buffers);
        for (auto piece = boost::asio::buffer_sequence_begin(buffers); piece != end; ++piece) {
            const boost::asio::const_buffer bytes(*piece);
            if (bytes.size() > 0) {
                return {static_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
            }
        }
        return {};
    }

    /// A close frame, after which nothing may follow (RFC 6455, 5.5.1).
    static hub::Outbox::Last is_last(std::span<const std::uint8_t> bytes) {
        constexpr std::uint8_t final_close = 0x88;
        return hub::Outbox::Last{!bytes.empty() && bytes[0] == final_close};
    }

    struct Read {
        OutboxStream* stream;

        template <class Handler, class Buffers>
        void operator()(Handler&& handler, const Buffers& buffers) const {
            auto& unread = stream->unread_;
            if (unread.empty()) {
                stream->outbox_->socket().async_read_some(buffers, std::forward<Handler>(handler));
                return;
            }
            const auto size = boost::asio::buffer_copy(buffers, boost::asio::buffer(unread));
            std::string(unread, size).swap(unread);  // which keeps no capacity
            boost::asio::post(
                stream->get_executor(),
                boost::beast::bind_front_handler(
                    std::forward<Handler>(handler),
                    boost::system::error_code{},
                    size
                )
            );
        }
    };

    struct Write {
        hub::Outbox* outbox;

        template <class Handler>
        void operator()(Handler&& handler, std::span<const std::uint8_t> bytes) const {
            // An outbox keeps what can be copied, and is in a hurry: the handler runs later.
            auto kept = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler));
            outbox->write(bytes, is_last(bytes), [kept, size = bytes.size()](auto failed) {
                boost::asio::post(
                    boost::beast::bind_front_handler(std::move(*kept), failed, failed ? 0 : size)
                );
            });
        }
    };

    hub::Outbox* outbox_;
    std::string unread_;
};

}  // namespace sweepcast::stream
