// Lanes: for each a queue of calls, and a thread for as long as there are any.
#include "driver/async/blocking.hpp"

#include <boost/asio/post.hpp>

#include <deque>
#include <map>
#include <pthread.h>
#include <thread>

namespace sweepcast::async {

namespace asio = boost::asio;

namespace {

/// A call in a lane.
struct Entry {
    std::function<void()> make;
    std::shared_ptr<detail::BlockingCall> awaited;  ///< empty: nobody waits for it
};

class Lanes : public std::enable_shared_from_this<Lanes> {
public:
    void enter(const std::string& lane, Entry entry) {
        const std::scoped_lock lock(mutex_);
        const auto [found, is_new] = queues_.try_emplace(lane);
        auto& queue = found->second;
        // Those that gave up on a lane that hangs must not pile up.
        std::erase_if(queue, [](const auto& each) {
            return each.awaited && each.awaited->abandoned();
        });
        queue.push_back(std::move(entry));
        if (is_new) {
            try {
                // A system call that never returns cannot be joined. The thread has hold of all
                // that it uses.
                std::thread([self = shared_from_this(), lane] { self->work(lane); }).detach();
            } catch (...) {
                queues_.erase(found);
                throw;
            }
        }
    }

private:
    void work(const std::string& lane) {
        pthread_setname_np(pthread_self(), "blocking calls");
        while (const auto entry = take(lane)) {
            entry->make();
        }
    }

    /// The next call of the lane; nothing, and the lane is gone, if there is none.
    std::optional<Entry> take(const std::string& lane) {
        const std::scoped_lock lock(mutex_);
        const auto found = queues_.find(lane);
        if (found->second.empty()) {
            queues_.erase(found);
            return std::nullopt;
        }
        Entry entry = std::move(found->second.front());
        found->second.pop_front();
        return entry;
    }

    std::mutex mutex_;
    std::map<std::string, std::deque<Entry>> queues_;  ///< one for each thread that runs
};

Lanes& lanes() {
    static const auto all = std::make_shared<Lanes>();
    return *all;
}

}  // namespace

namespace detail {

void BlockingCall::run() {
    if (abandoned()) {
        return;
    }
    try {
        make();
    } catch (...) {  // rethrown where it is waited for
        failure = std::current_exception();
    }
    const std::scoped_lock lock(mutex_);
    if (abandoned_) {
        drop();
        return;
    }
    asio::post(executor_, [self = shared_from_this()] {
        self->ended_ = true;
        self->changed_.notify();
    });
}

asio::awaitable<bool> BlockingCall::wait_until(std::chrono::steady_clock::time_point deadline) {
    while (!ended_) {
        const bool changed = co_await changed_.wait_until(deadline);
        if (!changed) {
            co_return ended_;
        }
    }
    co_return true;
}

void BlockingCall::abandon() {
    const std::scoped_lock lock(mutex_);
    abandoned_ = true;
}

bool BlockingCall::abandoned() const {
    const std::scoped_lock lock(mutex_);
    return abandoned_;
}

void enter_lane(const std::string& lane, std::shared_ptr<BlockingCall> call) {
    lanes().enter(lane, {[call] { call->run(); }, call});
}

}  // namespace detail

void start_blocking(const std::string& lane, std::function<void()> call) {
    lanes().enter(lane, {std::move(call), nullptr});
}

}  // namespace sweepcast::async
