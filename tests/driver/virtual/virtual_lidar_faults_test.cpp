// VirtualLidar: unplugged and plugged in again, and told what to suffer while it runs.
#include "driver/virtual/error.hpp"
#include "driver/virtual/listen_address.hpp"
#include "tests/driver/virtual/virtual_lidar_fixture.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <gmock/gmock.h>

#include <array>
#include <fstream>
#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

namespace sweepcast::virtual_lidar {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;
namespace ip = asio::ip;
using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;
using Bytes = std::vector<std::uint8_t>;
using protocol::Command;

const Bytes health_good{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 0, 0, 0};

class VirtualLidarFaults : public VirtualLidarTest {
protected:
    void obey(const std::string& text) {
        const auto command = parse_fault_command(text);
        ASSERT_TRUE(command) << command.error().cause;
        const auto obeyed = lidar_->obey(*command);
        EXPECT_TRUE(obeyed) << text << ": " << obeyed.error().cause;
    }

    Problem refused(const std::string& text) {
        const auto obeyed = lidar_->obey(*parse_fault_command(text));
        EXPECT_FALSE(obeyed) << text;
        return obeyed ? Problem{} : obeyed.error();
    }

    asio::awaitable<void> is_healthy() {
        auto port = open_port();
        co_await write(port, Command::get_health);
        EXPECT_EQ(co_await read(port, health_good.size()), health_good);
    }

    // Waits until the scanner answers again.
    asio::awaitable<void> booted() {
        auto port = open_port();
        asio::steady_timer timer(context_);
        Bytes heard;
        std::array<std::uint8_t, 256> buffer{};
        while (!std::equal(
            health_good.rbegin(),
            health_good.rend(),
            heard.rbegin(),
            heard.rend(),
            [](auto a, auto b) { return a == b; }
        )) {
            heard.clear();
            co_await write(port, Command::get_health);
            timer.expires_after(20ms);
            co_await timer.async_wait(asio::use_awaitable);
            const auto count = ::read(port.native_handle(), buffer.data(), buffer.size());
            if (count > 0) {
                heard.assign(buffer.begin(), buffer.begin() + count);
            }
        }
    }
};

// A host sees it as it sees a cable pulled: at once.
TEST_F(VirtualLidarFaults, UnpluggedItHangsUpOnItsHost) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port();
        co_await write(port, Command::get_health);
        co_await read(port, health_good.size());
        obey("unplug");
        EXPECT_FALSE(lidar_->is_plugged());
        std::uint8_t byte = 0;
        EXPECT_EQ(::read(port.native_handle(), &byte, 1), 0);  // a terminal that was hung up
        EXPECT_EQ(::write(port.native_handle(), &byte, 1), -1);
        EXPECT_EQ(errno, EIO);
        pollfd look{.fd = port.native_handle(), .events = POLLIN, .revents = 0};
        EXPECT_EQ(::poll(&look, 1, 0), 1);
        EXPECT_NE(look.revents & POLLHUP, 0);
    });
    EXPECT_THAT(log_.str(), HasSubstr("unplugged"));
}

TEST_F(VirtualLidarFaults, UnpluggedItsLinkAndItsPortAreGone) {
    const auto link = folder_.path("lidar");
    create({.link = link});
    const auto port = lidar_->port();
    obey("unplug");
    EXPECT_FALSE(fs::exists(fs::symlink_status(link)));
    EXPECT_FALSE(fs::exists(port));
    EXPECT_EQ(lidar_->port(), port);
    obey("replug");
    EXPECT_EQ(fs::read_symlink(link), lidar_->port());
    EXPECT_TRUE(lidar_->is_plugged());
}

TEST_F(VirtualLidarFaults, PluggedInAgainItBootsAndAnswersAtItsNewPort) {
    const auto link = folder_.path("lidar");
    create({.link = link});
    run_with([&]() -> asio::awaitable<void> {
        auto held = open_port();  // its host has not noticed yet, so the number is not free
        const auto before = lidar_->port();
        obey("unplug");
        obey("replug");
        EXPECT_NE(lidar_->port(), before);
        co_await booted();
        co_await is_healthy();
    });
    EXPECT_THAT(log_.str(), HasSubstr("has its power again, and boots"));
}

TEST_F(VirtualLidarFaults, PluggedInAgainItHasForgottenItsScan) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        {
            auto port = open_port();
            co_await write(port, Command::force_scan);
            co_await read(port, 500);
            EXPECT_EQ(lidar_->status().scan_mode, "Standard");
            obey("unplug");
            EXPECT_EQ(lidar_->status().scan_mode, "");
            obey("replug");
        }
        co_await booted();
        EXPECT_EQ(lidar_->status().scan_mode, "");
        auto port = open_port();
        co_await write(port, Command::force_scan);
        EXPECT_EQ((co_await read(port, 500)).size(), 500U);
    });
    EXPECT_EQ(lidar_->status().replugs, 1U);
}

TEST_F(VirtualLidarFaults, PluggedInElsewhereItStaysThere) {
    const auto first = folder_.path("first");
    const auto second = folder_.path("second");
    create({.link = first});
    obey("unplug");
    obey("replug " + second);
    EXPECT_FALSE(fs::exists(fs::symlink_status(first)));
    EXPECT_EQ(fs::read_symlink(second), lidar_->port());
    obey("unplug");
    obey("replug");
    EXPECT_EQ(fs::read_symlink(second), lidar_->port());
}

TEST_F(VirtualLidarFaults, ManyTimesInARowItLeavesNothingBehind) {
    const auto descriptors = [] {
        return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator());
    };
    create();
    const auto before = descriptors();
    run_with([&]() -> asio::awaitable<void> {
        for (int i = 0; i < 50; ++i) {
            obey("unplug");
            obey("replug");
        }
        co_await booted();
    });
    EXPECT_EQ(descriptors(), before);
    EXPECT_EQ(lidar_->status().replugs, 50U);
}

TEST_F(VirtualLidarFaults, WhatCannotBeNowIsRefused) {
    create();
    EXPECT_EQ(refused("replug").code, errc::not_now);
    EXPECT_EQ(refused("angle-restart").code, errc::not_now);
    obey("unplug");
    EXPECT_EQ(refused("unplug").code, errc::not_now);
    EXPECT_EQ(refused("reboot").code, errc::not_now);
    EXPECT_EQ(refused("replug /nonexistent/link").code, errc::link_unavailable);
    EXPECT_FALSE(lidar_->is_plugged());
    obey("replug");
}

TEST_F(VirtualLidarFaults, StopsAlsoWhileItIsUnplugged) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        obey("unplug");
        co_return;
    });
}

TEST_F(VirtualLidarFaults, AFaultThatBeginsUnpluggedShowsWhenPluggedIn) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        obey("unplug");
        obey("fault warning=7");
        obey("replug");
        auto port = open_port();
        Bytes answer;
        while (answer.size() < 10 || answer[7] != 1) {
            co_await write(port, Command::get_health);
            asio::steady_timer timer(context_, 20ms);
            co_await timer.async_wait(asio::use_awaitable);
            answer.assign(64, 0);
            const auto count = ::read(port.native_handle(), answer.data(), answer.size());
            answer.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
        }
        EXPECT_EQ(answer[8], 7);
    });
}

TEST_F(VirtualLidarFaults, OnTheNetworkItCutsAndRefusesAndIsThereAgain) {
    create({.listen = "tcp://127.0.0.1:0"});
    run_with([this]() -> asio::awaitable<void> {
        const auto address = parse_listen_address(lidar_->port(), Connection::serial);
        const ip::tcp::endpoint place(address->address, address->port);
        ip::tcp::socket host(context_);
        co_await host.async_connect(place, asio::use_awaitable);
        co_await write(host, Command::get_health);
        EXPECT_EQ(co_await read(host, health_good.size()), health_good);
        obey("unplug");
        error_code failed;
        std::array<std::uint8_t, 1> byte{};
        co_await host.async_read_some(
            asio::buffer(byte),
            asio::redirect_error(asio::use_awaitable, failed)
        );
        EXPECT_TRUE(failed);
        ip::tcp::socket next(context_);
        co_await next.async_connect(place, asio::redirect_error(asio::use_awaitable, failed));
        EXPECT_EQ(failed, asio::error::connection_refused);
        EXPECT_EQ(refused("replug /tmp/link").code, errc::invalid_option);
        obey("replug");
        EXPECT_EQ(lidar_->port(), to_url(*address));
        ip::tcp::socket again(context_);
        co_await again.async_connect(place, asio::use_awaitable);
        co_await logged("opened by a host");
    });
}

TEST_F(VirtualLidarFaults, WithEthernetOfItsOwnItIsThereAgainAtTheSameAddress) {
    create({.model = "t1", .listen = "udp://127.0.0.1:0"});
    run_with([this]() -> asio::awaitable<void> {
        const auto port = lidar_->port();
        obey("unplug");
        obey("replug");
        EXPECT_EQ(lidar_->port(), port);
        const auto address = parse_listen_address(port, Connection::ethernet);
        ip::udp::socket host(context_, ip::udp::v4());
        host.connect(ip::udp::endpoint(address->address, address->port));
        const auto request = protocol::encode({Command::get_health, {}});
        const auto boot_time = find_persona("t1")->boot_time;
        asio::steady_timer booting(context_, boot_time + 50ms);
        co_await booting.async_wait(asio::use_awaitable);
        co_await host.async_send(asio::buffer(request), asio::use_awaitable);
        Bytes answer(64);
        answer.resize(co_await host.async_receive(asio::buffer(answer), asio::use_awaitable));
        EXPECT_GE(answer.size(), 7U);
    });
}

// Not with UBSan, which looks at objects through a pipe and takes a lack of descriptors for an
// invalid object.
#ifndef SWEEPCAST_WITH_UBSAN
TEST_F(VirtualLidarFaults, OnTheNetworkItDoesNotSpinWhenDescriptorsRunOut) {
    create({.listen = "tcp://127.0.0.1:0"});
    const auto address = parse_listen_address(lidar_->port(), Connection::serial);
    ip::tcp::socket host(context_);
    host.connect(ip::tcp::endpoint(address->address, address->port));
    rlimit before{};
    ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
    const rlimit none{.rlim_cur = 3, .rlim_max = before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
    tasks_.spawn(lidar_->run());
    // One that spins is always ready for another step: the connection still waits.
    constexpr int many = 10'000;
    int steps = 0;
    while (steps < many && context_.poll_one() > 0) {
        ++steps;
    }
    ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
    EXPECT_GT(steps, 0);
    EXPECT_LT(steps, many);
    run_with_rest([&]() -> asio::awaitable<void> {
        co_await write(host, Command::get_health);
        EXPECT_EQ(co_await read(host, health_good.size()), health_good);
    });
}
#endif

TEST_F(VirtualLidarFaults, AScheduleIsObeyedByItself) {
    const auto link = folder_.path("lidar");
    create({.link = link, .schedule = {"30ms unplug, 60ms unplug", "90ms replug, 95ms fault mute"}}
    );
    run_with([this]() -> asio::awaitable<void> { co_await logged("faults: mute"); });
    EXPECT_THAT(log_.str(), HasSubstr("schedule: unplug: it is unplugged: plug it in first"));
    EXPECT_EQ(lidar_->status().replugs, 1U);
}

TEST_F(VirtualLidarFaults, ABadScheduleIsRefused) {
    const auto created =
        VirtualLidar::create(context_.get_executor(), {.schedule = {"3s explode"}}, logger_);
    ASSERT_FALSE(created);
    EXPECT_EQ(created.error().code, errc::invalid_option);
    EXPECT_THAT(created.error().cause, HasSubstr("explode"));
}

TEST_F(VirtualLidarFaults, FaultsBeginAndEndAndAreTold) {
    create({.faults = {"junk"}});
    EXPECT_EQ(lidar_->obey_line("fault noise=0.25"), "ok");
    EXPECT_EQ(lidar_->obey_line("fault nosie=0.25").rfind("error: there is no fault", 0), 0U);
    EXPECT_THAT(lidar_->obey_line(" status\r"), HasSubstr("faults=noise=0.25,junk"));
    EXPECT_EQ(lidar_->obey_line("clear junk"), "ok");
    EXPECT_THAT(lidar_->obey_line("status"), HasSubstr("faults=noise=0.25 "));
    EXPECT_EQ(lidar_->obey_line("clear"), "ok");
    EXPECT_EQ(
        lidar_->obey_line("status"),
        "ok port=" + lidar_->port() +
            " plugged=yes host=no scan=none faults=none replugs=0 packets=0 damaged=0 "
            "undetectable=0 unread_bytes=0"
    );
    EXPECT_THAT(log_.str(), HasSubstr("faults: noise=0.25,junk"));
    EXPECT_THAT(log_.str(), HasSubstr("faults: none"));
}

TEST_F(VirtualLidarFaults, IsToldThroughItsControlSocket) {
    const auto path = folder_.path("control");
    create({.control = path});
    run_with([&]() -> asio::awaitable<void> {
        asio::local::stream_protocol::socket control(context_);
        control.connect(asio::local::stream_protocol::endpoint(path));
        co_await asio::async_write(
            control,
            asio::buffer(std::string_view("unplug\n")),
            asio::use_awaitable
        );
        const auto answer = co_await read(control, 3);
        EXPECT_EQ(std::string(answer.begin(), answer.end()), "ok\n");
        EXPECT_FALSE(lidar_->is_plugged());
    });
    EXPECT_FALSE(fs::exists(path));
}

// Without the fault a host receives what was measured, at the line's speed, and no byte more.
TEST_F(VirtualLidarFaults, AFloodIsMoreThanALineCarries) {
    std::size_t measured = 0;
    create({
        .faults = {"flood"},
        .on_measured = [&](const Measured& packet) { measured += packet.bytes.size(); },
    });
    run_with([&]() -> asio::awaitable<void> {
        auto port = open_port();
        co_await write(port, Command::force_scan);
        constexpr std::size_t received = 500'000;
        co_await read(port, received);
        EXPECT_LT(measured, received / 2);
        obey("clear flood");
        obey("unplug");
    });
}

TEST_F(VirtualLidarFaults, AWrongSpeedIsGarbageToAHostWithTheRightOne) {
    create({.faults = {"wrong-baud"}});
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port();
        co_await logged("opened by a host");
        obey("banner");
        EXPECT_NE((co_await read(port, 8))[0], 'R');
        obey("clear");
    });
}

TEST_F(VirtualLidarFaults, TellsWhatItMeasuredToAHookAndAFile) {
    const auto truth = folder_.path("truth");
    Bytes measured;
    create({
        .faults = {"noise=0.5"},
        .truth = truth,
        .on_measured =
            [&](const Measured& packet) {
                EXPECT_EQ(packet.bytes.size(), 5U);
                EXPECT_EQ(packet.stream, (StreamId{1, protocol::AnswerType::normal}));
                measured.insert(measured.end(), packet.bytes.begin(), packet.bytes.end());
            },
    });
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port();
        co_await write(port, Command::force_scan);
        co_await read(port, 1000);
    });
    ASSERT_GE(measured.size(), 900U);
    std::ifstream file(truth);
    std::string line;
    std::getline(file, line);
    EXPECT_EQ(line.front(), '#');
    Bytes read;
    while (std::getline(file, line)) {
        ASSERT_EQ(line.size(), 5U + 10U);
        ASSERT_EQ(line.substr(0, 5), "1 81 ");
        for (std::size_t at = 5; at < line.size(); at += 2) {
            read.push_back(static_cast<std::uint8_t>(std::stoi(line.substr(at, 2), nullptr, 16)));
        }
    }
    EXPECT_EQ(read, measured);
    EXPECT_GT(lidar_->status().damage.damaged, 100U);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
