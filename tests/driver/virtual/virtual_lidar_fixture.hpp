// VirtualLidarTest: a virtual lidar and beside it a host of the test's own.
#pragma once

#include "driver/async/task_group.hpp"
#include "driver/protocol/request.hpp"
#include "driver/virtual/virtual_lidar.hpp"
#include "tests/driver/virtual/scratch_folder.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>

#include <exception>
#include <fcntl.h>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace sweepcast::virtual_lidar {

class VirtualLidarTest : public testing::Test {
protected:
    using Command = protocol::Command;
    using Bytes = std::vector<std::uint8_t>;

    VirtualLidarTest()
        : tasks_(context_.get_executor(), [this](std::exception_ptr failure) {
            failure_ = failure;
            lidar_->stop();
        }) {}

    void create(const VirtualLidarOptions& options = {}) {
        auto created = VirtualLidar::create(context_.get_executor(), options, logger_);
        ASSERT_TRUE(created) << created.error().cause;
        lidar_ = std::move(*created);
    }

    /// Runs the lidar and beside it `host`; when that has ended the lidar is stopped.
    void run_with(std::function<boost::asio::awaitable<void>()> host) {
        tasks_.spawn(lidar_->run());
        run_with_rest(std::move(host));
    }

    /// The same of a lidar that runs already.
    void run_with_rest(std::function<boost::asio::awaitable<void>()> host) {
        tasks_.spawn(host_then_stop(std::move(host)));
        context_.run_for(std::chrono::seconds(60));
        ASSERT_EQ(tasks_.size(), 0U) << "did not end in time";
        if (failure_) {
            std::rethrow_exception(failure_);
        }
    }

    boost::asio::posix::stream_descriptor open_port() {
        const int port = ::open(lidar_->port().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
        EXPECT_GE(port, 0);
        return {context_, port};
    }

    template <class Port>
    static boost::asio::awaitable<void> write(Port& port, Command command) {
        const auto request = protocol::encode({command, {}});
        co_await boost::asio::async_write(
            port,
            boost::asio::buffer(request),
            boost::asio::use_awaitable
        );
    }

    template <class Port>
    static boost::asio::awaitable<Bytes> read(Port& port, std::size_t size) {
        Bytes bytes(size);
        co_await boost::asio::async_read(
            port,
            boost::asio::buffer(bytes),
            boost::asio::use_awaitable
        );
        co_return bytes;
    }

    /// Waits, with the ceiling of run_with, until the log tells of something.
    boost::asio::awaitable<void> logged(std::string text) {
        boost::asio::steady_timer timer(context_);
        while (log_.str().find(text) == std::string::npos) {
            timer.expires_after(std::chrono::milliseconds(5));
            co_await timer.async_wait(boost::asio::use_awaitable);
        }
    }

    boost::asio::io_context context_;
    std::ostringstream log_;
    std::shared_ptr<spdlog::logger> logger_ = std::make_shared<spdlog::logger>(
        "test",
        std::make_shared<spdlog::sinks::ostream_sink_st>(log_)
    );
    ScratchFolder folder_;
    std::unique_ptr<VirtualLidar> lidar_;
    async::TaskGroup tasks_;
    std::exception_ptr failure_;

private:
    boost::asio::awaitable<void> host_then_stop(std::function<boost::asio::awaitable<void>()> host
    ) {
        co_await host();
        lidar_->stop();
    }
};

}  // namespace sweepcast::virtual_lidar
