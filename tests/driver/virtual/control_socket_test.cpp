// ControlSocket: lines in, lines out, on a real Unix socket.
#include "driver/virtual/control_socket.hpp"

#include "driver/virtual/error.hpp"
#include "tests/driver/virtual/scratch_folder.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sys/stat.h>
#include <thread>

namespace sweepcast::virtual_lidar {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;
using asio::local::stream_protocol;
using testing::HasSubstr;

class ControlSocketTest : public testing::Test {
protected:
    ControlSocketTest()
        : tasks_(context_.get_executor(), [](const std::exception_ptr& failure) {
            std::rethrow_exception(failure);
        }) {}

    std::unique_ptr<ControlSocket> open() {
        auto opened =
            ControlSocket::open(context_.get_executor(), path_, [this](std::string_view line) {
                lines_.emplace_back(line);
                return "heard " + std::string(line);
            });
        EXPECT_TRUE(opened) << opened.error().cause;
        return opened ? std::move(*opened) : nullptr;
    }

    Problem cannot_open() {
        auto opened = ControlSocket::open(
            context_.get_executor(),
            path_,
            [](std::string_view) -> std::string { return {}; }
        );
        EXPECT_FALSE(opened);
        return opened ? Problem{} : opened.error();
    }

    // Serves until `client` has ended.
    void serve_while(std::function<asio::awaitable<void>()> client) {
        const auto control = open();
        tasks_.spawn(control->run());
        tasks_.spawn(then_cancel(std::move(client)));
        context_.run_for(std::chrono::seconds(60));
        ASSERT_EQ(tasks_.size(), 0U) << "did not end in time";
    }

    stream_protocol::socket connect() {
        stream_protocol::socket socket(context_);
        socket.connect(stream_protocol::endpoint(path_));
        return socket;
    }

    static asio::awaitable<void> write(stream_protocol::socket& socket, std::string text) {
        co_await asio::async_write(socket, asio::buffer(text), asio::use_awaitable);
    }

    // The next line; empty if the connection has ended.
    static asio::awaitable<std::string>
    read_line(stream_protocol::socket& socket, std::string& received) {
        error_code failed;
        const auto size = co_await asio::async_read_until(
            socket,
            asio::dynamic_buffer(received),
            '\n',
            asio::redirect_error(asio::use_awaitable, failed)
        );
        if (failed) {
            co_return std::string();
        }
        const auto line = received.substr(0, size - 1);
        received.erase(0, size);
        co_return line;
    }

    asio::io_context context_;
    ScratchFolder folder_;
    std::string path_ = folder_.path("control");
    std::vector<std::string> lines_;
    async::TaskGroup tasks_;

private:
    asio::awaitable<void> then_cancel(std::function<asio::awaitable<void>()> client) {
        co_await client();
        tasks_.cancel();
    }
};

TEST_F(ControlSocketTest, AnswersEachLineInItsOrder) {
    serve_while([this]() -> asio::awaitable<void> {
        auto socket = connect();
        std::string received;
        co_await write(socket, "one\ntwo\nth");
        EXPECT_EQ(co_await read_line(socket, received), "heard one");
        EXPECT_EQ(co_await read_line(socket, received), "heard two");
        co_await write(socket, "ree\n");
        EXPECT_EQ(co_await read_line(socket, received), "heard three");
    });
    EXPECT_FALSE(fs::exists(path_));
}

TEST_F(ControlSocketTest, TakesALastLineWithoutAnEnd) {
    serve_while([this]() -> asio::awaitable<void> {
        auto socket = connect();
        std::string received;
        co_await write(socket, "unplug");
        socket.shutdown(stream_protocol::socket::shutdown_send);
        EXPECT_EQ(co_await read_line(socket, received), "heard unplug");
        EXPECT_EQ(co_await read_line(socket, received), "");
    });
}

TEST_F(ControlSocketTest, RefusesALineThatIsTooLongAndTakesOneThatIsNot) {
    serve_while([this]() -> asio::awaitable<void> {
        std::string received;
        auto socket = connect();
        co_await write(socket, std::string(ControlSocket::longest_line, 'x') + "\n");
        EXPECT_EQ((co_await read_line(socket, received)).size(), 1024U + 6U);
        co_await write(socket, std::string(ControlSocket::longest_line + 1, 'x'));
        EXPECT_THAT(co_await read_line(socket, received), HasSubstr("error: the line is too long"));
        EXPECT_EQ(co_await read_line(socket, received), "");
    });
    EXPECT_EQ(lines_.size(), 1U);
}

TEST_F(ControlSocketTest, ServesSeveralAtOnceButNotAnyNumber) {
    serve_while([this]() -> asio::awaitable<void> {
        std::vector<stream_protocol::socket> sockets;
        std::string received;
        for (std::size_t i = 0; i < ControlSocket::most_connections; ++i) {
            sockets.push_back(connect());
            co_await write(sockets.back(), "here\n");
            EXPECT_EQ(co_await read_line(sockets.back(), received), "heard here");
        }
        auto beyond = connect();
        EXPECT_THAT(co_await read_line(beyond, received), HasSubstr("too many connections"));
        sockets.erase(sockets.begin());
        // That one has gone shows as soon as the socket has read its end.
        for (std::string answer; answer != "heard again";) {
            auto next = connect();
            co_await write(next, "again\n");
            answer = co_await read_line(next, received);
        }
    });
}

TEST_F(ControlSocketTest, IsOpenToThisUserOnly) {
    const auto control = open();
    struct stat found {};
    ASSERT_EQ(::stat(path_.c_str(), &found), 0);
    EXPECT_EQ(found.st_mode & 0777U, 0600U);
}

TEST_F(ControlSocketTest, ReplacesWhatADeadProcessHasLeft) {
    { stream_protocol::acceptor dead(context_, stream_protocol::endpoint(path_)); }
    ASSERT_TRUE(fs::exists(path_));
    EXPECT_NE(open(), nullptr);
    EXPECT_FALSE(fs::exists(path_));
}

TEST_F(ControlSocketTest, LeavesTheSocketOfAnotherAndAnyFileAlone) {
    {
        const auto control = open();
        const auto problem = cannot_open();
        EXPECT_EQ(problem.code, errc::control_unavailable);
        EXPECT_THAT(problem.cause, HasSubstr("of another virtual lidar"));
        EXPECT_TRUE(fs::exists(path_));
    }
    std::ofstream(path_) << "mine";
    EXPECT_THAT(cannot_open().cause, HasSubstr("is not a socket"));
    EXPECT_EQ(fs::file_size(path_), 4U);
}

TEST_F(ControlSocketTest, DoesNotRemoveWhatSomeoneElseHasPutInItsPlace) {
    auto control = open();
    fs::remove(path_);
    std::ofstream(path_) << "mine";
    control.reset();
    EXPECT_TRUE(fs::exists(path_));
}

TEST_F(ControlSocketTest, SaysWhichPathsCannotBe) {
    path_ = folder_.path("nowhere/control");
    EXPECT_THAT(cannot_open().cause, HasSubstr("No such file"));
    path_ = folder_.path(std::string(200, 'x'));
    EXPECT_THAT(cannot_open().hint, HasSubstr("1 to 107 bytes"));
}

TEST_F(ControlSocketTest, IsAskedByThoseWhoBlock) {
    const auto none = ask_control_socket(path_, "status");
    ASSERT_FALSE(none);
    EXPECT_THAT(none.error().hint, HasSubstr("sweepcast virtual --control " + path_));

    const auto control = open();
    tasks_.spawn(control->run());
    std::thread server([this] { context_.run(); });
    const auto answered = ask_control_socket(path_, "status");
    asio::post(context_, [this] { tasks_.cancel(); });
    server.join();
    ASSERT_TRUE(answered) << answered.error().cause;
    EXPECT_EQ(*answered, "heard status");
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
