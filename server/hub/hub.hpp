// Hub: from the lidars' threads to every worker's share. One post per worker and publication,
// whatever the number of clients.
#pragma once

#include "server/hub/local_hub.hpp"
#include "server/hub/publication.hpp"

#include <boost/asio/io_context.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

namespace sweepcast::hub {

/// Publishing is safe from any thread. The workers must have stopped before it is destroyed.
class Hub {
public:
    using Executor = boost::asio::io_context::executor_type;

    /// A hub over these workers, given by their executors.
    explicit Hub(const std::vector<Executor>& workers);

    void publish(SweepNews news);
    void publish(StateNews news);

    /// True if some subscriber wants frames so: only then are they worth encoding.
    [[nodiscard]] bool wanted(frame::Compression compression) const;

    /// The share of worker `index`; to be used on that worker's thread.
    [[nodiscard]] LocalHub& local(std::size_t index) { return shares_[index]->local; }

    /// Sweeps not handed to a worker because it was too far behind.
    [[nodiscard]] std::uint64_t sweeps_withheld() const { return sweeps_withheld_; }

private:
    struct Share {
        Share(Executor worker, Demand& demand) : executor(worker), local(demand) {}
        Executor executor;
        LocalHub local;
        /// Sweeps posted and not delivered yet.
        std::atomic<std::uint32_t> pending{};
    };

    Demand demand_{};
    std::vector<std::unique_ptr<Share>> shares_;
    std::atomic<std::uint64_t> sweeps_withheld_{};
};

}  // namespace sweepcast::hub
