#include "tests/chaos/watcher.hpp"

#include "server/client/stream_client.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <exception>
#include <stdexcept>
#include <unistd.h>
#include <utility>

namespace sweepcast::chaos {

namespace asio = boost::asio;
using namespace std::chrono_literals;

namespace {

/// A line that changed bytes may have left some in a sweep under way, or in a buffer.
constexpr auto damage_lasts = 4s;
/// What was measured is known here by then.
constexpr auto truth_comes_within = 5s;
constexpr auto compare_every = 100ms;

bool has_losses(const protocol::LineLosses& losses) {
    return losses.checksum_errors + losses.skipped_bytes + losses.lost_packets > 0;
}

}  // namespace

Watcher::Watched::Watched(asio::io_context& context, const Lidar& which)
    : lidar(&which)
    , fifo(context, ::dup(which.truth()))
    , truth(which.persona())
    , compare_from(Clock::now()) {}

Watcher::Watcher(const std::string& tcp, const std::vector<std::unique_ptr<Lidar>>& lidars) {
    for (const auto& lidar : lidars) {
        watched_.push_back(std::make_unique<Watched>(context_, *lidar));
    }
    const auto guarded = [this](std::exception_ptr failure) {
        if (failure) {
            try {
                std::rethrow_exception(failure);
            } catch (const std::exception& what) {
                fail(what.what());
            }
        }
    };
    for (auto& watched : watched_) {
        asio::co_spawn(context_, read_truth(*watched), guarded);
    }
    asio::co_spawn(context_, receive(tcp), guarded);
    asio::co_spawn(context_, compare(), guarded);
    thread_ = std::thread([this] { context_.run(); });
}

Watcher::~Watcher() {
    context_.stop();
    thread_.join();
}

void Watcher::set_damaged(std::size_t lidar, bool damaged) {
    const std::lock_guard lock(mutex_);
    watched_[lidar]->compare_from =
        damaged ? Clock::time_point::max() : Clock::now() + damage_lasts;
}

Seen Watcher::seen(std::size_t lidar) const {
    const std::lock_guard lock(mutex_);
    return watched_[lidar]->seen;
}

Totals Watcher::totals() const {
    const std::lock_guard lock(mutex_);
    auto totals = totals_;
    for (const auto& watched : watched_) {
        totals.sweeps += watched->seen.sweeps;
        totals.skipped += watched->seen.skipped;
    }
    return totals;
}

bool Watcher::wait_until(Clock::time_point then, const std::function<bool()>& holds) const {
    for (;;) {
        if (holds()) {
            return true;
        }
        std::unique_lock lock(mutex_);
        if (failure_.empty()) {
            changed_.wait_until(lock, std::min(then, Clock::now() + 50ms));
        }
        if (!failure_.empty()) {
            throw std::runtime_error(failure_);
        }
        if (Clock::now() >= then) {
            return false;
        }
    }
}

void Watcher::wait_until(Clock::time_point then) const {
    (void)wait_until(then, [] { return false; });
}

void Watcher::fail(const std::string& what) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) {
        failure_ = what;
    }
    changed_.notify_all();
}

asio::awaitable<void> Watcher::receive(const std::string& tcp) {
    auto connected = co_await client::StreamClient::connect(
        *client::parse_stream_url("tcp://" + tcp),
        test::patience
    );
    if (!connected) {
        throw std::runtime_error(connected.error().cause);
    }
    const auto client = std::move(*connected);
    v1::Subscribe everything;
    const auto subscribed = co_await client->subscribe(everything);
    if (!subscribed) {
        throw std::runtime_error("the subscriber lost its connection");
    }
    for (;;) {
        const auto message = co_await client->receive();
        if (!message) {
            throw std::runtime_error(
                "the subscriber lost its connection: " + message.error().message()
            );
        }
        take(**message);
    }
}

asio::awaitable<void> Watcher::read_truth(Watched& watched) {
    for (;;) {
        const auto size = co_await watched.fifo.async_read_some(
            asio::buffer(watched.buffer),
            asio::use_awaitable
        );
        watched.truth.take({watched.buffer.data(), size});
    }
}

asio::awaitable<void> Watcher::compare() {
    asio::steady_timer timer(context_);
    for (;;) {
        timer.expires_after(compare_every);
        co_await timer.async_wait(asio::use_awaitable);
        for (auto& watched : watched_) {
            compare(*watched);
        }
    }
}

void Watcher::take(const v1::ServerMessage& message) {
    const std::lock_guard lock(mutex_);
    for (const auto& lidar : message.hello().lidars()) {
        take_lidar(lidar);
    }
    if (message.has_lidar()) {
        take_lidar(message.lidar());
    }
    if (message.has_frame()) {
        take_frame(message.frame());
    }
    if (message.has_stats()) {
        totals_.dropped = message.stats().frames_dropped();
    }
    if (message.has_error() || message.has_closing()) {
        throw std::runtime_error("the gateway refuses: " + message.ShortDebugString());
    }
    changed_.notify_all();
}

void Watcher::take_lidar(const v1::Lidar& lidar) {
    for (auto& watched : watched_) {
        if (lidar.url() == watched->lidar->link()) {
            auto& seen = watched->seen;
            if (lidar.state() != seen.lidar.state()) {
                seen.changed = Clock::now();
            }
            if (lidar.state() == v1::Lidar::FAILED && lidar.hint().empty()) {
                throw std::runtime_error(lidar.url() + " has failed, without advice");
            }
            seen.lidar = lidar;
            by_id_[lidar.id()] = watched.get();
        }
    }
}

void Watcher::take_frame(const v1::Frame& frame) {
    const auto found = by_id_.find(frame.lidar());
    if (found == by_id_.end()) {
        throw std::runtime_error("a sweep of an unknown lidar " + frame.lidar());
    }
    auto& watched = *found->second;
    auto& seen = watched.seen;
    if (seen.sweeps > 0 && frame.sequence() <= seen.sequence) {
        throw std::runtime_error(fmt::format(
            "{}: sweep {} comes after sweep {}",
            watched.lidar->link(),
            frame.sequence(),
            seen.sequence
        ));
    }
    seen.skipped += seen.sweeps > 0 ? frame.sequence() - seen.sequence - 1 : 0;
    seen.sequence = frame.sequence();
    ++seen.sweeps;
    seen.last_sweep = Clock::now();
    auto scan = decoder_.decode(frame);
    if (!scan) {
        throw std::runtime_error("a frame does not decode: " + scan.error().message());
    }
    if (seen.last_sweep >= watched.compare_from) {
        watched.to_compare.push_back({seen.last_sweep, frame.sequence(), std::move(*scan)});
    } else {
        ++totals_.sweeps_not_compared;
    }
}

void Watcher::compare(Watched& watched) {
    const std::lock_guard lock(mutex_);
    while (!watched.to_compare.empty()) {
        const auto& sweep = watched.to_compare.front();
        const auto& samples = sweep.scan.sweep.samples;
        const auto found = watched.truth.find(samples, sweep.scan.answer_type);
        if (found == Found::no) {
            if (Clock::now() > sweep.came + truth_comes_within) {
                // A capsule before a loss has its share of the turn, not to the bit what it would
                // have had, and the loss is told with what follows it: the next sweep, maybe.
                if (has_losses(sweep.scan.sweep.losses) ||
                    (watched.to_compare.size() > 1 &&
                     has_losses(watched.to_compare[1].scan.sweep.losses))) {
                    ++totals_.sweeps_not_found;
                    watched.to_compare.pop_front();
                    continue;
                }
                throw std::runtime_error(fmt::format(
                    "{}: the {} samples of sweep {} (mode {}) were not all measured so, in that "
                    "order; not at all: those at {}",
                    watched.lidar->link(),
                    samples.size(),
                    sweep.sequence,
                    sweep.scan.mode,
                    watched.truth.unknown(samples)
                ));
            }
            return;
        }
        ++totals_.sweeps_compared;
        totals_.samples_compared += samples.size();
        totals_.sweeps_with_holes += found == Found::with_holes ? 1 : 0;
        watched.to_compare.pop_front();
    }
}

}  // namespace sweepcast::chaos
