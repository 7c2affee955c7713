// Opening what a URL names, on this machine's own ports, and what is said when that fails.
#include "driver/link/open_link.hpp"

#include "driver/async/blocking.hpp"
#include "tests/driver/link/link_peers.hpp"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/use_future.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <future>
#include <string>

namespace sweepcast::link {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;
using testing::HasSubstr;

class OpenLinkTest : public testing::Test {
protected:
    Result<std::unique_ptr<Link>, Problem>
    open(const std::string& text, std::chrono::milliseconds limit = 10s) {
        const auto url = parse_link_url(text);
        if (!url) {
            throw std::runtime_error(url.error().cause);
        }
        auto opened = asio::co_spawn(
            context_,
            open_link(context_.get_executor(), *url, 256000, limit),
            asio::use_future
        );
        context_.restart();
        while (opened.wait_for(0s) != std::future_status::ready && context_.run_one_for(60s) != 0) {
        }
        return opened.get();
    }

    /// Listens on a port of its own.
    tcp::acceptor listen(const char* address) {
        return {context_, tcp::endpoint(asio::ip::make_address(address), 0)};
    }

    static std::string port_of(const tcp::acceptor& acceptor) {
        return std::to_string(acceptor.local_endpoint().port());
    }

    asio::io_context context_;
};

TEST_F(OpenLinkTest, OpensASerialPortAtTheSpeedAskedFor) {
    const PtyPair pty;
    const auto link = open("serial:" + pty.path() + "?baud=115200");
    ASSERT_TRUE(link) << link.error().cause;
    EXPECT_EQ((*link)->baud(), 256000U);
    EXPECT_FALSE((*link)->is_network());
}

TEST_F(OpenLinkTest, GivesUpAPortWhoseDriverHangsAndOpensOthersMeanwhile) {
    const PtyPair hanging;
    const PtyPair other;
    std::promise<void> released;
    async::start_blocking(hanging.path(), [wait = released.get_future().share()] { wait.wait(); });
    const auto link = open(hanging.path(), 50ms);
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, errc::timed_out);
    EXPECT_EQ(
        link.error().cause,
        "opening " + hanging.path() + " hangs: its driver does not answer"
    );
    EXPECT_TRUE(open(other.path()));
    released.set_value();
    EXPECT_TRUE(open(hanging.path())) << "it is well again";
}

TEST_F(OpenLinkTest, OpensAPortThatWasJustClosed) {
    const PtyPair pty;
    for (int i = 0; i < 20; ++i) {
        EXPECT_TRUE(open(pty.path()));
    }
}

TEST_F(OpenLinkTest, ConnectsToAnAddress) {
    auto acceptor = listen("127.0.0.1");
    const auto link = open("tcp://127.0.0.1:" + port_of(acceptor));
    ASSERT_TRUE(link) << link.error().cause;
    EXPECT_TRUE((*link)->is_network());
    EXPECT_EQ((*link)->baud(), 0U);
}

TEST_F(OpenLinkTest, ConnectsToAName) {
    auto acceptor = listen("127.0.0.1");
    const auto link = open("tcp://localhost:" + port_of(acceptor));
    EXPECT_TRUE(link) << link.error().cause;
}

TEST_F(OpenLinkTest, SaysThatNothingListens) {
    auto acceptor = listen("127.0.0.1");
    const auto port = port_of(acceptor);
    acceptor.close();
    const auto link = open("tcp://127.0.0.1:" + port);
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, errc::connection_refused);
    EXPECT_EQ(link.error().cause, "nothing listens at tcp://127.0.0.1:" + port);
}

TEST_F(OpenLinkTest, SaysThatNobodyAnswersInTime) {
    // With one connection that nobody accepts the system answers no more.
    tcp::acceptor acceptor(context_, tcp::v4());
    acceptor.bind({asio::ip::address_v4::loopback(), 0});
    acceptor.listen(0);
    tcp::socket first(context_);
    first.connect(acceptor.local_endpoint());
    const auto link = open("tcp://127.0.0.1:" + port_of(acceptor), 20ms);
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, errc::timed_out);
}

TEST_F(OpenLinkTest, SaysThatThereIsNoSuchHost) {
    const std::string no_name(64, 'x');  // too long a label to be asked for
    const auto link = open("udp://" + no_name);
    ASSERT_FALSE(link);
    EXPECT_EQ(link.error().code, errc::host_not_found);
    EXPECT_THAT(link.error().cause, HasSubstr(no_name));
}

TEST_F(OpenLinkTest, OpensUdpWithoutAWordFromTheScanner) {
    const auto link = open("udp://127.0.0.1");
    ASSERT_TRUE(link) << link.error().cause;
    EXPECT_TRUE((*link)->is_network());
}

TEST_F(OpenLinkTest, ThrowsWhenCancelled) {
    tcp::acceptor acceptor(context_, tcp::v4());
    acceptor.bind({asio::ip::address_v4::loopback(), 0});
    acceptor.listen(0);
    tcp::socket first(context_);
    first.connect(acceptor.local_endpoint());
    asio::cancellation_signal cancel;
    std::exception_ptr failure;
    bool ended = false;
    asio::co_spawn(
        context_,
        open_link(
            context_.get_executor(),
            *parse_link_url("tcp://127.0.0.1:" + port_of(acceptor)),
            0,
            10s
        ),
        asio::bind_cancellation_slot(
            cancel.slot(),
            [&](std::exception_ptr thrown, const Result<std::unique_ptr<Link>, Problem>&) {
                failure = std::move(thrown);
                ended = true;
            }
        )
    );
    context_.poll();
    ASSERT_FALSE(ended);
    cancel.emit(asio::cancellation_type::terminal);
    context_.restart();
    while (!ended && context_.run_one_for(60s) != 0) {
    }
    EXPECT_TRUE(failure);
}

struct Case {
    error_code error;
    error_code code;
    const char* cause;
};

class ConnectErrorTest : public testing::TestWithParam<Case> {};

error_code system_error(int value) {
    return {value, boost::system::system_category()};
}

TEST_P(ConnectErrorTest, HasACauseAndANextStep) {
    const auto problem = explain_connect_error("tcp", "fe80::1", 20108, GetParam().error);
    EXPECT_EQ(problem.code, GetParam().code);
    EXPECT_THAT(problem.cause, HasSubstr(GetParam().cause));
    EXPECT_THAT(problem.cause, HasSubstr("fe80::1"));
    EXPECT_FALSE(problem.hint.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Errors,
    ConnectErrorTest,
    testing::Values(
        Case{
            system_error(ECONNREFUSED),
            errc::connection_refused,
            "nothing listens at tcp://[fe80::1]:20108"},
        Case{system_error(EHOSTUNREACH), errc::unreachable, "cannot be reached"},
        Case{system_error(ENETUNREACH), errc::unreachable, "cannot be reached"},
        Case{system_error(ETIMEDOUT), errc::timed_out, "did not answer"},
        Case{errc::timed_out, errc::timed_out, "did not answer"},
        Case{asio::error::host_not_found, errc::host_not_found, "there is no host"},
        Case{asio::error::host_not_found_try_again, errc::host_not_found, "no name service"},
        Case{system_error(EMFILE), system_error(EMFILE), "failed: "}
    )
);

}  // namespace
}  // namespace sweepcast::link
