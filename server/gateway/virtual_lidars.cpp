#include "server/gateway/virtual_lidars.hpp"

#include <boost/asio/post.hpp>

#include <utility>

namespace sweepcast::gateway {

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
    options.seed = number;
    auto created =
        virtual_lidar::VirtualLidar::create(worker_->executor(), options, std::move(log));
    if (!created) {
        return created.error();
    }
    auto& lidar = *lidars_.emplace_back(std::move(*created));
    boost::asio::post(worker_->executor(), [this, &lidar] { worker_->tasks().spawn(lidar.run()); });
    return lidar.port();
}

void VirtualLidars::stop() {
    if (worker_) {
        worker_->stop();
    }
    // Only the thread touched them, and it has ended. Their sockets need the worker's context: they
    // go first.
    lidars_.clear();
    worker_.reset();
}

}  // namespace sweepcast::gateway
