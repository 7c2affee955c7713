// Beat: a steady rhythm to publish frames in.
#pragma once

#include <cstdint>
#include <sys/timerfd.h>
#include <unistd.h>

namespace sweepcast::bench {

class Beat {
public:
    explicit Beat(unsigned hz) : timer_(timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC)) {
        constexpr std::int64_t second_ns = 1'000'000'000;
        const timespec period{hz == 1 ? 1 : 0, hz == 1 ? 0 : second_ns / hz};
        const itimerspec rhythm{period, period};
        timerfd_settime(timer_, 0, &rhythm, nullptr);
    }
    ~Beat() { close(timer_); }
    Beat(const Beat&) = delete;
    Beat& operator=(const Beat&) = delete;

    /// Waits for the next beat; not at all if it is late already.
    void wait() {
        if (due_ == 0) {
            (void)!read(timer_, &due_, sizeof due_);  // there is nothing to fail
        }
        --due_;
    }

private:
    int timer_;
    std::uint64_t due_{};
};

}  // namespace sweepcast::bench
