#include "server/hub/hub.hpp"

#include <boost/asio/post.hpp>

#include <utility>

namespace sweepcast::hub {

namespace {

/// A worker that has not taken this many sweeps and sectors is stuck; more would only pile up.
constexpr std::uint32_t most_pending = 512;

}  // namespace

Hub::Hub(const std::vector<Executor>& workers) {
    for (const auto& executor : workers) {
        shares_.push_back(std::make_unique<Share>(executor, variants_));
    }
}

void Hub::publish(SweepNews news) {
    publish_frames(std::move(news));
}

void Hub::publish(SectorNews news) {
    if (!news.frames.empty()) {
        publish_frames(std::move(news));
    }
}

template <class News>
void Hub::publish_frames(News news) {
    const auto shared = std::make_shared<const News>(std::move(news));
    for (const auto& share : shares_) {
        if (share->pending.load() >= most_pending) {
            ++frames_withheld_;
            continue;
        }
        ++share->pending;
        boost::asio::post(share->executor, [share = share.get(), shared] {
            --share->pending;
            share->local.deliver(*shared);
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

}  // namespace sweepcast::hub
