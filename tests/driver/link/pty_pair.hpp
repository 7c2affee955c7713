// PtyPair: a pseudo-terminal. The test holds the master, as the device; the code under test opens
// the slave.
#pragma once

#include <array>
#include <cstdint>
#include <fcntl.h>
#include <poll.h>
#include <span>
#include <stdexcept>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): posix_openpt is POSIX, not C++
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

namespace sweepcast::link {

class PtyPair {
public:
    PtyPair() : master_(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
        std::array<char, 64> name{};
        if (master_ < 0 || ::grantpt(master_) != 0 || ::unlockpt(master_) != 0 ||
            ::ptsname_r(master_, name.data(), name.size()) != 0) {
            throw std::runtime_error("no pseudo-terminal to be had");
        }
        path_ = name.data();
    }
    PtyPair(const PtyPair&) = delete;
    PtyPair& operator=(const PtyPair&) = delete;
    ~PtyPair() { hang_up(); }

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] int fd() const { return master_; }

    void send(std::span<const std::uint8_t> bytes) const {
        if (::write(master_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
            throw std::runtime_error("short write to a pseudo-terminal");
        }
    }

    /// Up to `most` bytes that the other side wrote; waits for the first, at most ten seconds.
    [[nodiscard]] std::vector<std::uint8_t> receive(std::size_t most) const {
        pollfd waiting{master_, POLLIN, 0};
        if (::poll(&waiting, 1, 10'000) != 1) {
            throw std::runtime_error("nothing came out of a pseudo-terminal");
        }
        std::vector<std::uint8_t> bytes(most);
        const auto count = ::read(master_, bytes.data(), bytes.size());
        bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
        return bytes;
    }

    void hang_up() {
        if (const int fd = std::exchange(master_, -1); fd >= 0) {
            ::close(fd);
        }
    }

private:
    int master_;
    std::string path_;
};

}  // namespace sweepcast::link
