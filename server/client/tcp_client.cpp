// A stream over TCP: each message has its length in front as a varint.
#include "server/client/connections.hpp"
#include "server/frame/message_framing.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>

#include <array>
#include <utility>
#include <vector>

namespace sweepcast::client {

namespace asio = boost::asio;
using asio::ip::tcp;

namespace {

class TcpClient final : public StreamClient {
public:
    explicit TcpClient(tcp::socket socket) : socket_(std::move(socket)) {}

    void close() override {
        error_code ignored;  // it is given up anyway
        socket_.close(ignored);
    }

private:
    asio::awaitable<Result<void>> send(std::string message) override {
        std::vector<std::uint8_t> bytes;
        const std::vector<std::uint8_t> plain(message.begin(), message.end());
        frame::append_delimited(bytes, plain);
        const auto [failed, sent] = co_await asio::async_write(
            socket_,
            asio::buffer(bytes),
            asio::as_tuple(asio::use_awaitable)
        );
        co_return failed ? Result<void>(failed) : Result<void>{};
    }

    asio::awaitable<Result<std::span<const std::uint8_t>>> receive_bytes() override {
        for (;;) {
            auto message = reader_.next();
            if (!message) {
                co_return message.error();
            }
            if (*message) {
                co_return **message;
            }
            const auto [failed, got] = co_await socket_.async_read_some(
                asio::buffer(chunk_),
                asio::as_tuple(asio::use_awaitable)
            );
            if (failed) {
                co_return failed;
            }
            bytes_received_ += got;
            reader_.push(std::span(chunk_).first(got));
        }
    }

    tcp::socket socket_;
    frame::DelimitedReader reader_{longest_server_message};
    std::array<std::uint8_t, 16UL * 1024> chunk_{};
};

}  // namespace

std::unique_ptr<StreamClient> make_tcp_client(tcp::socket socket) {
    return std::make_unique<TcpClient>(std::move(socket));
}

}  // namespace sweepcast::client
