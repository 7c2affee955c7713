// serve_http over a socket within the process.
#include "server/http/http_session.hpp"

#include "sweepcast/v1/stream.pb.h"
#include "tests/server/hub/socket_pair.hpp"
#include "tests/server/stream/known_lidar.hpp"

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/system/system_error.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <array>
#include <exception>
#include <future>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace sweepcast::http {
namespace {

namespace asio = boost::asio;
namespace bhttp = boost::beast::http;
using testing::HasSubstr;

/// Fails as told, or obeys.
class FailingControl final : public api::LidarControl {
public:
    asio::awaitable<Outcome> start(std::uint32_t, std::string) override { return obey(); }
    asio::awaitable<Outcome> stop(std::uint32_t) override { return obey(); }
    asio::awaitable<Outcome> reset(std::uint32_t) override { return obey(); }
    asio::awaitable<Outcome> update(std::uint32_t, api::LidarUpdate) override { return obey(); }
    asio::awaitable<Result<device::Diagnosis, Problem>> diagnose(std::uint32_t) override {
        co_return device::Diagnosis{};
    }

    std::exception_ptr failure;
    int obeyed{};

private:
    asio::awaitable<Outcome> obey() {
        ++obeyed;
        if (failure) {
            std::rethrow_exception(failure);
        }
        co_return api::Obeyed{stream::known_lidar(), false};
    }
};

struct Answer {
    int status{};
    std::string body;
};

class HttpSessionTest : public testing::Test {
protected:
    HttpSessionTest() {
        stream::add_known_lidar(hub);
        auto [client_end, gateway_end] = hub::socket_pair(context.get_executor());
        client = std::move(client_end);
        served = asio::co_spawn(
            context,
            serve_http(std::move(gateway_end), {api, hub, hosts, {}, log}),
            asio::use_future
        );
    }
    ~HttpSessionTest() override {
        client.close();
        EXPECT_TRUE(comes(served));
    }

    /// Runs until the future is ready; false if nothing happens any more.
    template <class T>
    bool comes(const std::future<T>& future) {
        context.restart();
        while (future.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
            if (context.run_one_for(std::chrono::seconds(10)) == 0) {
                return false;
            }
        }
        return true;
    }
    template <class T>
    T run(asio::awaitable<T> task) {
        auto done = asio::co_spawn(context, std::move(task), asio::use_future);
        if (!comes(done)) {
            throw std::runtime_error("nothing came");
        }
        return done.get();
    }

    void send(const std::string& bytes) {
        EXPECT_EQ(asio::write(client, asio::buffer(bytes)), bytes.size());
    }
    Answer read_answer() {
        return run([](HttpSessionTest& test) -> asio::awaitable<Answer> {
            bhttp::response_parser<bhttp::string_body> parser;
            co_await bhttp::async_read(test.client, test.buffer, parser, asio::use_awaitable);
            co_return Answer{
                static_cast<int>(parser.get().result_int()),
                std::move(parser.get().body())};
        }(*this));
    }
    Answer ask(const std::string& bytes) {
        send(bytes);
        return read_answer();
    }

    /// The next so many bytes that come.
    std::string read_bytes(std::size_t count) {
        return run([](HttpSessionTest& test, std::size_t wanted) -> asio::awaitable<std::string> {
            if (test.buffer.size() < wanted) {
                const auto missing = wanted - test.buffer.size();
                const auto space = test.buffer.prepare(missing);
                co_await asio::async_read(test.client, space, asio::use_awaitable);
                test.buffer.commit(missing);
            }
            const std::string bytes(static_cast<const char*>(test.buffer.cdata().data()), wanted);
            test.buffer.consume(wanted);
            co_return bytes;
        }(*this, count));
    }
    /// The next message of the stream.
    v1::ServerMessage read_message() {
        const auto header = read_bytes(2);
        EXPECT_EQ(header[0], '\x82') << "no whole binary message";
        std::size_t size = static_cast<unsigned char>(header[1]);
        if (size == 126) {
            const auto extended = read_bytes(2);
            size = static_cast<unsigned char>(extended[0]) * 256U +
                   static_cast<unsigned char>(extended[1]);
        }
        v1::ServerMessage message;
        EXPECT_TRUE(message.ParseFromString(read_bytes(size)));
        return message;
    }

    asio::io_context context;
    hub::Variants variants;
    hub::LocalHub hub{variants};
    FailingControl control;
    api::Api api{hub, control};
    HostNames hosts{{"robot"}};
    std::ostringstream logged;
    std::shared_ptr<spdlog::logger> log = std::make_shared<spdlog::logger>(
        "test",
        std::make_shared<spdlog::sinks::ostream_sink_st>(logged)
    );
    asio::ip::tcp::socket client{context};
    boost::beast::flat_buffer buffer;
    std::future<void> served;
};

const std::string start = "POST /api/v1/lidars/A0E1C2D3/start HTTP/1.1\r\n";
const std::string healthz = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
const std::string upgrade =
    "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
const std::string stream_request = "GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\n" + upgrade;

/// A Subscribe as a WebSocket message of a client, whose mask is 0.
std::string subscribe_bytes(std::uint32_t request) {
    v1::ClientMessage message;
    message.mutable_subscribe()->set_request(request);
    const auto body = message.SerializeAsString();
    return std::string("\x82") + static_cast<char>(0x80U | body.size()) + std::string(4, '\0') +
           body;
}

TEST_F(HttpSessionTest, ReadsWhatAClientSendsTogetherWithItsUpgrade) {
    EXPECT_EQ(ask(stream_request + subscribe_bytes(5)).status, 101);
    EXPECT_TRUE(read_message().has_hello());
    EXPECT_EQ(read_message().subscribed().wish().request(), 5U);
}

TEST_F(HttpSessionTest, ReadsAMessageThatBeginsTogetherWithTheUpgrade) {
    const auto message = subscribe_bytes(6);
    EXPECT_EQ(ask(stream_request + subscribe_bytes(5) + message.substr(0, 3)).status, 101);
    EXPECT_TRUE(read_message().has_hello());
    EXPECT_EQ(read_message().subscribed().wish().request(), 5U);
    send(message.substr(3) + subscribe_bytes(7));
    EXPECT_EQ(read_message().subscribed().wish().request(), 6U);
    EXPECT_EQ(read_message().subscribed().wish().request(), 7U);
}

TEST_F(HttpSessionTest, AnErrorOfTheSystemInAHandlerIsAnsweredAndLogged) {
    const auto io_error = boost::system::errc::make_error_code(boost::system::errc::io_error);
    control.failure = std::make_exception_ptr(boost::system::system_error(io_error));
    const auto answer = ask(start + "Host: localhost\r\n\r\n");
    EXPECT_EQ(answer.status, 500);
    EXPECT_THAT(answer.body, HasSubstr("\"internal_error\""));
    EXPECT_THAT(logged.str(), HasSubstr("/api/v1/lidars/A0E1C2D3/start"));
    EXPECT_EQ(ask(healthz).status, 200) << "the connection goes on";
}

TEST_F(HttpSessionTest, AnyOtherExceptionInAHandlerIsAnsweredToo) {
    control.failure = std::make_exception_ptr(std::runtime_error("broken"));
    EXPECT_EQ(ask(start + "Host: localhost\r\n\r\n").status, 500);
    EXPECT_THAT(logged.str(), HasSubstr("broken"));
    EXPECT_EQ(ask(healthz).status, 200);
}

struct Host {
    std::string what, header;
    int status;
};

void PrintTo(const Host& host, std::ostream* out) {
    *out << host.what;
}

class HostTest : public HttpSessionTest, public testing::WithParamInterface<Host> {};

TEST_P(HostTest, DecidesWhoMayCommand) {
    const auto& host = GetParam();
    EXPECT_EQ(ask(start + host.header + "\r\n").status, host.status);
    EXPECT_EQ(control.obeyed, host.status == 200 ? 1 : 0);
}

TEST_P(HostTest, DecidesWhoMayLook) {
    const auto& host = GetParam();
    for (const auto* const path : {"/", "/healthz", "/api/v1/lidars"}) {
        const auto request = std::string("GET ") + path + " HTTP/1.1\r\n";
        EXPECT_EQ(ask(request + host.header + "\r\n").status, host.status) << path;
    }
}

TEST_P(HostTest, DecidesWhoMaySubscribe) {
    const auto& host = GetParam();
    const auto status = ask("GET /api/v1/stream HTTP/1.1\r\n" + host.header + upgrade).status;
    EXPECT_EQ(status, host.status == 200 ? 101 : host.status);
}

INSTANTIATE_TEST_SUITE_P(
    Headers,
    HostTest,
    testing::Values(
        Host{"address", "Host: 127.0.0.1:8080\r\n", 200},
        Host{"address6", "Host: [::1]:8080\r\n", 200},
        Host{"name", "Host: ROBOT.:8080\r\n", 200},
        Host{"rebound", "Host: evil.example:8080\r\nOrigin: http://evil.example:8080\r\n", 421},
        Host{"missing", "", 400},
        Host{"empty", "Host:\r\n", 400},
        Host{"twice", "Host: localhost\r\nHost: evil.example\r\n", 400},
        Host{"malformed", "Host: localhost:x\r\n", 400}
    ),
    [](const auto& host) { return host.param.what; }
);

TEST_F(HttpSessionTest, ShowsTheBytesOfAHostHeaderThatAreNotUtf8) {
    const auto answer = ask("GET /healthz HTTP/1.1\r\nHost: \xff\xfe\r\n\r\n");
    EXPECT_EQ(answer.status, 400);
    EXPECT_THAT(
        answer.body,
        HasSubstr(R"(the Host header \"\\xff\\xfe\" is no host name or address)")
    );
}

TEST_F(HttpSessionTest, SaysHowAnotherNameBecomesOurs) {
    const auto answer = ask("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n");
    EXPECT_THAT(answer.body, HasSubstr("\"unknown_host\""));
    EXPECT_THAT(answer.body, HasSubstr("evil.example"));
    EXPECT_THAT(answer.body, HasSubstr("--host-name"));
}

TEST_F(HttpSessionTest, HttpOneZeroNeedsNoHost) {
    EXPECT_EQ(ask("GET /healthz HTTP/1.0\r\n\r\n").status, 200);
}

}  // namespace
}  // namespace sweepcast::http
