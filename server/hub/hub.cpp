#include "server/hub/hub.hpp"

#include <boost/asio/post.hpp>

#include <utility>

namespace sweepcast::hub {

namespace {

/// A worker that has not taken this many sweeps is stuck; more would only pile up.
constexpr std::uint32_t most_pending_sweeps = 256;

}  // namespace

Hub::Hub(const std::vector<Executor>& workers) {
    for (const auto& executor : workers) {
        shares_.push_back(std::make_unique<Share>(executor, demand_));
    }
}

void Hub::publish(SweepNews news) {
    for (const auto& share : shares_) {
        if (share->pending.load() >= most_pending_sweeps) {
            ++sweeps_withheld_;
            continue;
        }
        ++share->pending;
        boost::asio::post(share->executor, [share = share.get(), news] {
            --share->pending;
            share->local.deliver(news);
        });
    }
}

void Hub::publish(StateNews news) {
    for (const auto& share : shares_) {
        boost::asio::post(share->executor, [share = share.get(), news] {
            share->local.deliver(news);
        });
    }
}

bool Hub::wanted(frame::Compression compression) const {
    return demand_[static_cast<std::size_t>(compression)].load(std::memory_order_relaxed) > 0;
}

}  // namespace sweepcast::hub
