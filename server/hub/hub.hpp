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
    void publish(SectorNews news);
    void publish(StateNews news);

    /// What subscribers want: only that is worth encoding.
    [[nodiscard]] const Variants& variants() const { return variants_; }

    /// The share of worker `index`; to be used on that worker's thread.
    [[nodiscard]] LocalHub& local(std::size_t index) { return shares_[index]->local; }

    /// Publications of sweeps and sectors not handed to a worker because it was too far behind.
    [[nodiscard]] std::uint64_t frames_withheld() const { return frames_withheld_; }

private:
    struct Share {
        Share(Executor worker, Variants& variants) : executor(worker), local(variants) {}
        Executor executor;
        LocalHub local;
        /// Sweeps and sectors posted and not delivered yet.
        std::atomic<std::uint32_t> pending{};
    };

    template <class News>
    void publish_frames(News news);

    Variants variants_;
    std::vector<std::unique_ptr<Share>> shares_;
    std::atomic<std::uint64_t> frames_withheld_{};
};

}  // namespace sweepcast::hub
