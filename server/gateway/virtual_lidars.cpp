#include "server/gateway/virtual_lidars.hpp"

#include <boost/asio/post.hpp>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

namespace sweepcast::gateway {

namespace fs = std::filesystem;

Result<std::string, Problem> VirtualLidars::add(
    const VirtualLidarUrl& url,
    std::uint32_t number,
    std::shared_ptr<spdlog::logger> log
) {
    if (!worker_) {
        worker_ = std::make_unique<async::Worker>("virtual lidars", on_failure_);
    }
    virtual_lidar::VirtualLidarOptions options;
    options.model = url.model;
    options.world = url.world;
    options.faults = url.faults;
    options.schedule = url.schedule;
    options.control = url.control;
    if (!url.schedule.empty() || !url.control.empty()) {
        auto link = link_for(number);
        if (!link) {
            return link;
        }
        options.link = std::move(*link);
    }
    options.seed = number;
    auto created =
        virtual_lidar::VirtualLidar::create(worker_->executor(), options, std::move(log));
    if (!created) {
        return created.error();
    }
    auto& lidar = **created;
    // Read before it runs: on its thread it may be plugged in elsewhere.
    auto port = options.link.empty() ? lidar.port() : options.link;
    {
        const std::scoped_lock lock(mutex_);
        lidars_.insert_or_assign(number, std::move(*created));
    }
    boost::asio::post(worker_->executor(), [this, number, &lidar] {
        worker_->tasks().spawn(play(number, lidar));
    });
    return port;
}

/// Its life; its port goes with it.
boost::asio::awaitable<void>
VirtualLidars::play(std::uint32_t number, virtual_lidar::VirtualLidar& lidar) {
    co_await lidar.run();
    const std::scoped_lock lock(mutex_);
    lidars_.erase(number);
}

void VirtualLidars::end(std::uint32_t number) {
    boost::asio::post(worker_->executor(), [this, number] {
        const std::scoped_lock lock(mutex_);
        const auto found = lidars_.find(number);
        if (found != lidars_.end()) {
            found->second->stop();
        }
    });
}

// A path that stays the same, in a folder that nobody else may write to.
Result<std::string, Problem> VirtualLidars::link_for(std::uint32_t number) {
    if (links_.empty()) {
        std::error_code failed;
        auto path = (fs::temp_directory_path(failed) / "sweepcast-virtual-XXXXXX").string();
        if (!failed && ::mkdtemp(path.data()) == nullptr) {
            failed.assign(errno, std::generic_category());
        }
        if (failed) {
            return Problem{
                make_error_code(boost::system::errc::io_error),
                "cannot make a folder for the virtual lidar's link: " + failed.message(),
                "set TMPDIR to a folder that exists and that you may write to"};
        }
        links_ = std::move(path);
    }
    return links_ + "/lidar-" + std::to_string(number);
}

void VirtualLidars::stop() {
    if (worker_) {
        worker_->stop();
    }
    // Only the thread touched them, and it has ended. Their sockets need the worker's context: they
    // go first.
    lidars_.clear();
    worker_.reset();
    if (!links_.empty()) {
        std::error_code ignored;  // a leftover folder does no harm
        fs::remove_all(std::exchange(links_, {}), ignored);
    }
}

}  // namespace sweepcast::gateway
