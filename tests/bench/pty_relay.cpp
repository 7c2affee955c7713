#include "tests/bench/pty_relay.hpp"

#include <array>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <stdexcept>
#include <termios.h>
#include <unistd.h>

namespace sweepcast::bench {

namespace {

constexpr std::size_t packet_bytes = 84;
constexpr std::array<std::uint8_t, 7> descriptor{0xA5, 0x5A, 0x54, 0x00, 0x00, 0x40, 0x85};

void check(bool is_well, const char* what) {
    if (!is_well) {
        throw std::runtime_error(what);
    }
}

void make_raw(int terminal) {
    termios settings{};
    check(::tcgetattr(terminal, &settings) == 0, "no terminal");
    const auto speed = ::cfgetospeed(&settings);
    ::cfmakeraw(&settings);
    ::cfsetspeed(&settings, speed);
    check(::tcsetattr(terminal, TCSANOW, &settings) == 0, "a terminal that takes no settings");
}

}  // namespace

PtyRelay::PtyRelay(const std::string& lidar) {
    device_ = ::open(lidar.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    check(device_ >= 0, "the lidar's terminal cannot be opened");
    make_raw(device_);
    master_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    check(master_ >= 0 && ::grantpt(master_) == 0 && ::unlockpt(master_) == 0, "no terminal");
    make_raw(master_);
    path_ = ::ptsname(master_);
    check(::pipe(wake_) == 0, "no pipe");
    thread_ = std::thread([this] { run(); });
}

PtyRelay::~PtyRelay() {
    (void)!::write(wake_[1], "", 1);
    thread_.join();
    for (const int descriptor_of : {device_, master_, wake_[0], wake_[1]}) {
        ::close(descriptor_of);
    }
}

std::vector<Clock::time_point> PtyRelay::packets() {
    const std::lock_guard lock(mutex_);
    return packets_;
}

void PtyRelay::run() {
    std::array<pollfd, 3> waiting{
        pollfd{device_, POLLIN, 0},
        pollfd{master_, POLLIN, 0},
        pollfd{wake_[0], POLLIN, 0}};
    while (::poll(waiting.data(), waiting.size(), -1) > 0 && waiting[2].revents == 0) {
        if ((waiting[0].revents & POLLIN) != 0) {
            pass(device_, master_, true);
        }
        if ((waiting[1].revents & POLLIN) != 0) {
            pass(master_, device_, false);
        } else if ((waiting[1].revents & POLLHUP) != 0) {  // nobody has opened the other end
            ::poll(nullptr, 0, 1);
        }
    }
}

bool PtyRelay::pass(int from, int to, bool measured) {
    std::array<std::uint8_t, 4096> bytes{};
    const auto count = ::read(from, bytes.data(), bytes.size());
    if (count <= 0) {
        return false;
    }
    const auto passed = std::span(bytes).first(static_cast<std::size_t>(count));
    if (measured) {
        note(passed);
    }
    return ::write(to, passed.data(), passed.size()) == count;
}

void PtyRelay::note(std::span<const std::uint8_t> bytes) {
    const auto now = Clock::now();
    for (const auto byte : bytes) {
        if (matched_ < descriptor.size()) {
            matched_ =
                byte == descriptor[matched_] ? matched_ + 1 : (byte == descriptor[0] ? 1U : 0U);
            continue;
        }
        if (++received_ % packet_bytes == 0) {
            const std::lock_guard lock(mutex_);
            packets_.push_back(now);
        }
    }
}

}  // namespace sweepcast::bench
