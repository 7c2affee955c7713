// VirtualLidar: the whole, talked to through its port by a host of the test's own.
#include "driver/virtual/error.hpp"
#include "tests/driver/virtual/virtual_lidar_fixture.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace sweepcast::virtual_lidar {
namespace {

namespace asio = boost::asio;
namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;
using protocol::Command;

const Bytes health_good{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 0, 0, 0};

TEST_F(VirtualLidarTest, AnswersOnItsPort) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port();
        co_await write(port, Command::get_health);
        EXPECT_EQ(co_await read(port, health_good.size()), health_good);
    });
}

TEST_F(VirtualLidarTest, AnswersARequestThatWasSentBeforeItRan) {
    create();
    auto port = open_port();
    const auto request = protocol::encode({Command::get_health, {}});
    ASSERT_EQ(::write(port.native_handle(), request.data(), request.size()), 2);
    run_with([&]() -> asio::awaitable<void> {
        EXPECT_EQ(co_await read(port, health_good.size()), health_good);
    });
}

TEST_F(VirtualLidarTest, ServesOneHostAfterTheOther) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        for (int i = 0; i < 3; ++i) {
            auto port = open_port();
            co_await write(port, Command::get_health);
            EXPECT_EQ(co_await read(port, health_good.size()), health_good);
            port.close();
            log_.str("");
            co_await logged("closed by the host");
        }
    });
}

TEST_F(VirtualLidarTest, LeavesNothingOfAScanForTheNextHost) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        auto first = open_port();
        co_await write(first, Command::force_scan);
        co_await read(first, 500);
        first.close();  // without STOP, as after a crash
        co_await logged("closed by the host");
        auto second = open_port();
        std::array<std::uint8_t, 100> stale{};
        EXPECT_EQ(::read(second.native_handle(), stale.data(), stale.size()), -1);
        EXPECT_EQ(errno, EAGAIN);
    });
}

TEST_F(VirtualLidarTest, GoesOnScanningForAHostThatComesBack) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        auto first = open_port();
        co_await write(first, Command::force_scan);
        co_await read(first, 500);
        first.close();
        co_await logged("closed by the host");
        auto second = open_port();
        EXPECT_EQ((co_await read(second, 100)).size(), 100U);
    });
}

TEST_F(VirtualLidarTest, RecordsTheMeasurementBytesThatWereSent) {
    const auto recording = folder_.path("recording");
    create({.recording = recording});
    Bytes received;
    run_with([&]() -> asio::awaitable<void> {
        auto port = open_port();
        co_await write(port, Command::force_scan);
        co_await read(port, 7);
        received = co_await read(port, 1000);
    });
    std::ifstream file(recording, std::ios::binary);
    Bytes recorded{std::istreambuf_iterator<char>(file), {}};
    ASSERT_GE(recorded.size(), received.size());
    recorded.resize(received.size());
    EXPECT_EQ(recorded, received);
}

TEST_F(VirtualLidarTest, LosesWhatAHostDoesNotReadAndSaysSo) {
    create();
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port();
        co_await write(port, Command::force_scan);
        co_await logged("bytes lost");
    });
    EXPECT_THAT(log_.str(), HasSubstr("the host does not read"));
}

TEST_F(VirtualLidarTest, LinksItsPortWhileItRuns) {
    const auto link = folder_.path("lidar");
    create({.link = link});
    EXPECT_EQ(fs::read_symlink(link), lidar_->port());
    run_with([]() -> asio::awaitable<void> { co_return; });
    EXPECT_FALSE(fs::exists(fs::symlink_status(link)));
}

TEST_F(VirtualLidarTest, TellsInTheLogWhatAUserWantsToKnow) {
    const auto link = folder_.path("lidar");
    create({.link = link});
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port();
        const auto motor_off = protocol::encode(protocol::set_motor_pwm_request(0));
        co_await asio::async_write(port, asio::buffer(motor_off), asio::use_awaitable);
        co_await logged("motor off");
        co_await write(port, Command::scan);
        co_await logged("scan started: Standard");
        co_await write(port, Command::reset);
        co_await logged("reset");
    });
    EXPECT_THAT(log_.str(), HasSubstr("listening on " + lidar_->port() + " (link " + link + ")"));
    EXPECT_THAT(log_.str(), HasSubstr("scan stopped: Standard"));
}

TEST_F(VirtualLidarTest, StopsAlsoBeforeItHasBegun) {
    create();
    lidar_->stop();
    tasks_.spawn(lidar_->run());
    context_.run_for(60s);
    EXPECT_EQ(tasks_.size(), 0U);
}

TEST_F(VirtualLidarTest, EndsTidilyWhenCancelled) {
    const auto link = folder_.path("lidar");
    create({.link = link});
    tasks_.spawn(lidar_->run());
    asio::post(context_, [this] { tasks_.cancel(); });
    context_.run_for(60s);
    EXPECT_EQ(tasks_.size(), 0U);
    EXPECT_FALSE(fs::exists(fs::symlink_status(link)));
    EXPECT_FALSE(failure_);
}

TEST_F(VirtualLidarTest, CanBeDestroyedInMidScan) {
    create({.link = folder_.path("lidar")});
    tasks_.spawn(lidar_->run());
    auto port = open_port();
    const auto request = protocol::encode({Command::force_scan, {}});
    ASSERT_EQ(::write(port.native_handle(), request.data(), request.size()), 2);
    while (log_.str().find("scan started") == std::string::npos) {
        ASSERT_EQ(context_.run_one_for(60s), 1U);
    }
    lidar_.reset(
    );  // as at the end of a worker: nothing runs any more, coroutines go with the context
    EXPECT_FALSE(fs::exists(fs::symlink_status(folder_.path("lidar"))));
}

TEST_F(VirtualLidarTest, TakesTheSerialNumberGiven) {
    create({.serial = "000102030405060708090A0B0C0D0E0F"});
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port();
        co_await write(port, Command::get_info);
        const auto answer = co_await read(port, 27);
        for (std::size_t i = 0; i < 16; ++i) {
            EXPECT_EQ(answer[11 + i], i);
        }
    });
}

struct BadOption {
    const char* name;
    VirtualLidarOptions options;
    errc code;
};
void PrintTo(const BadOption& option, std::ostream* out) {
    *out << option.name;
}

class BadOptions : public testing::TestWithParam<BadOption> {};

TEST_P(BadOptions, AreRefusedWithACauseAndAHint) {
    asio::io_context context;
    std::ostringstream log;
    const auto logger = std::make_shared<spdlog::logger>(
        "test",
        std::make_shared<spdlog::sinks::ostream_sink_st>(log)
    );
    const auto created = VirtualLidar::create(context.get_executor(), GetParam().options, logger);
    ASSERT_FALSE(created);
    EXPECT_EQ(created.error().code, GetParam().code);
    EXPECT_FALSE(created.error().cause.empty());
    EXPECT_FALSE(created.error().hint.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Options,
    BadOptions,
    testing::Values(
        BadOption{"model", {.model = "b2"}, errc::invalid_option},
        BadOption{"serial", {.serial = "12"}, errc::invalid_option},
        BadOption{"negative_noise", {.noise_mm = -1.0}, errc::invalid_option},
        BadOption{"noise_nan", {.noise_mm = std::nan("")}, errc::invalid_option},
        BadOption{"dropout", {.dropout = 1.01}, errc::invalid_option},
        BadOption{"dropout_nan", {.dropout = std::nan("")}, errc::invalid_option},
        BadOption{"world", {.world = "no/such/file.csv"}, errc::world_unreadable},
        BadOption{"link", {.link = "no/such/folder/link"}, errc::link_unavailable},
        BadOption{"recording", {.recording = "no/such/folder/file"}, errc::recording_unavailable}
    ),
    [](const auto& test) { return std::string(test.param.name); }
);

}  // namespace
}  // namespace sweepcast::virtual_lidar
