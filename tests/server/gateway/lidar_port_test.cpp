// When a port is worth another try.
#include "server/gateway/lidar_port.hpp"

#include "driver/link/error.hpp"
#include "tests/driver/link/pty_pair.hpp"
#include "tests/driver/link/scratch_directory.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <future>
#include <string>

namespace sweepcast::gateway {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;

class LidarPortTest : public testing::Test {
protected:
    error_code open() {
        auto opening = asio::co_spawn(context_, port_.open(115200), asio::use_future);
        run_until_ready(opening);
        auto opened = opening.get();
        return opened ? error_code() : opened.error().code;
    }
    std::future<void> wait(std::chrono::milliseconds limit) {
        const auto deadline = std::chrono::steady_clock::now() + limit;
        auto waiting = asio::co_spawn(context_, port_.wait_for_change(deadline), asio::use_future);
        context_.restart();
        context_.poll();
        return waiting;
    }
    static bool ready(const auto& future) {
        return future.wait_for(0s) == std::future_status::ready;
    }
    void run_until_ready(const auto& future) {
        const auto give_up = std::chrono::steady_clock::now() + 60s;
        context_.restart();
        while (!ready(future) && context_.run_one_until(give_up) != 0) {
        }
        ASSERT_TRUE(ready(future));
    }

    link::ScratchDirectory scratch_;
    link::PtyPair pty_;
    asio::io_context context_;
    std::string path_{(scratch_.root() / "lidar").string()};
    LidarPort port_{context_.get_executor(), {path_, link::SerialPlace{path_, {}}}};
};

TEST_F(LidarPortTest, WaitsForAPortThatIsNotThere) {
    EXPECT_EQ(open(), link::errc::port_not_found);
    auto waiting = wait(1h);
    EXPECT_FALSE(ready(waiting));
    scratch_.link("lidar", pty_.path());
    run_until_ready(waiting);
    EXPECT_EQ(open(), error_code());
}

TEST_F(LidarPortTest, DoesNotWaitForAPortThatCameMeanwhile) {
    EXPECT_EQ(open(), link::errc::port_not_found);
    scratch_.link("lidar", pty_.path());
    EXPECT_TRUE(ready(wait(1h)));
}

TEST_F(LidarPortTest, TakesADanglingLinkForAPortThatIsNotThere) {
    scratch_.link("lidar", scratch_.root() / "unplugged");
    EXPECT_EQ(open(), link::errc::port_not_found);
    auto waiting = wait(1h);
    EXPECT_FALSE(ready(waiting));
    std::filesystem::remove(path_);
    scratch_.link("lidar", pty_.path());
    run_until_ready(waiting);
}

TEST_F(LidarPortTest, WaitsOutTheTimeIfNothingChanges) {
    scratch_.link("lidar", pty_.path());
    EXPECT_EQ(open(), error_code());
    auto waiting = wait(50ms);
    EXPECT_FALSE(ready(waiting)) << "that we opened it is no change";
    run_until_ready(waiting);
}

TEST_F(LidarPortTest, SeesThatAPortWentThatCouldBeOpened) {
    scratch_.link("lidar", pty_.path());
    EXPECT_EQ(open(), error_code());
    std::filesystem::remove(path_);
    EXPECT_TRUE(ready(wait(1h)));
}

}  // namespace
}  // namespace sweepcast::gateway
