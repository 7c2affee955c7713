// PtyRelay: stands between a virtual lidar's pseudo terminal and the gateway, and notes when each
// packet of a dense stream (0x85, 84 bytes) was handed over.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace sweepcast::bench {

using Clock = std::chrono::steady_clock;

class PtyRelay {
public:
    /// Before the lidar at this path. Throws if there are no pseudo terminals to be had.
    explicit PtyRelay(const std::string& lidar);
    ~PtyRelay();
    PtyRelay(const PtyRelay&) = delete;
    PtyRelay& operator=(const PtyRelay&) = delete;

    /// What the gateway is to open.
    [[nodiscard]] const std::string& path() const { return path_; }

    /// Just before the last byte of each packet since the stream began was written.
    [[nodiscard]] std::vector<Clock::time_point> packets();

private:
    void run();
    bool pass(int from, int to, bool measured);
    void note(std::span<const std::uint8_t> bytes);

    int device_{-1};
    int master_{-1};
    int wake_[2]{-1, -1};
    std::string path_;
    std::mutex mutex_;
    std::vector<Clock::time_point> packets_;
    std::size_t matched_{};   ///< bytes of the stream's descriptor seen
    std::size_t received_{};  ///< bytes of the stream
    std::thread thread_;
};

}  // namespace sweepcast::bench
