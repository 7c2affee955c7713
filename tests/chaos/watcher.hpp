// Watcher: a subscriber of all lidars, in a thread of its own, that checks what it is sent.
#pragma once

#include "server/frame/frame_decoder.hpp"
#include "sweepcast/v1/stream.pb.h"
#include "tests/chaos/child.hpp"
#include "tests/chaos/truth.hpp"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace sweepcast::chaos {

using Clock = std::chrono::steady_clock;

/// What the watcher has seen of a lidar so far.
struct Seen {
    v1::Lidar lidar;              ///< as the gateway last told
    Clock::time_point changed{};  ///< when it last told of another state than before
    Clock::time_point last_sweep{};
    std::uint64_t sequence{};
    std::uint64_t sweeps{};
    std::uint64_t skipped{};  ///< numbers of sweeps that did not come
};

struct Totals {
    std::uint64_t sweeps{};
    std::uint64_t skipped{};
    std::uint64_t dropped{};  ///< as the gateway told
    std::uint64_t samples_compared{};
    std::uint64_t sweeps_compared{};
    std::uint64_t sweeps_with_holes{};
    std::uint64_t sweeps_not_compared{};
    /// Of which, or of the sweep after it, the gateway itself says that bytes were lost, and which
    /// were not measured so: a busy machine loses some where no fault does.
    std::uint64_t sweeps_not_found{};
};

class Watcher {
public:
    /// Connects and begins. The lidars outlive it.
    Watcher(const std::string& tcp, const std::vector<std::unique_ptr<Lidar>>& lidars);
    ~Watcher();
    Watcher(const Watcher&) = delete;
    Watcher& operator=(const Watcher&) = delete;

    /// From now on (until told otherwise) its sweeps are not compared with what was measured: its
    /// line changes bytes, which checksums cannot always tell.
    void set_damaged(std::size_t lidar, bool damaged);

    [[nodiscard]] Seen seen(std::size_t lidar) const;
    [[nodiscard]] Totals totals() const;

    /// Waits until `holds` (asked after each message), or until then. Throws as soon as an
    /// invariant is broken.
    bool wait_until(Clock::time_point then, const std::function<bool()>& holds) const;
    /// Waits until then, otherwise alike.
    void wait_until(Clock::time_point then) const;

private:
    struct Sweep {
        Clock::time_point came;
        std::uint64_t sequence{};
        frame::DecodedScan scan;
    };
    struct Watched {
        Watched(boost::asio::io_context& context, const Lidar& which);
        const Lidar* lidar;
        boost::asio::posix::stream_descriptor fifo;
        std::array<char, 65536> buffer{};
        Truth truth;
        std::deque<Sweep> to_compare;
        Clock::time_point compare_from;  // max: damaged now
        Seen seen;
    };

    boost::asio::awaitable<void> receive(const std::string& tcp);
    boost::asio::awaitable<void> read_truth(Watched& watched);
    boost::asio::awaitable<void> compare();
    void take(const v1::ServerMessage& message);
    void take_lidar(const v1::Lidar& lidar);
    void take_frame(const v1::Frame& frame);
    void compare(Watched& watched);
    void fail(const std::string& what);

    boost::asio::io_context context_{1};
    frame::FrameDecoder decoder_;
    mutable std::mutex mutex_;
    mutable std::condition_variable changed_;
    std::vector<std::unique_ptr<Watched>> watched_;
    std::map<std::string, Watched*> by_id_;
    Totals totals_;
    std::string failure_;
    std::thread thread_;
};

}  // namespace sweepcast::chaos
