#include "driver/virtual/pty.hpp"

#include "driver/virtual/error.hpp"

#include <boost/asio/use_awaitable.hpp>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace asio = boost::asio;

namespace {

Problem unavailable(const std::string& what, int failure) {
    return {
        errc::port_unavailable,
        "cannot open a pseudo terminal: " + what + ": " + std::strerror(failure),
        "check that /dev/ptmx and /dev/pts are there, and the limit /proc/sys/kernel/pty/max",
    };
}

// The host's end, open for as long as this lives.
class HostEnd {
public:
    explicit HostEnd(const std::string& port)
        : descriptor_(::open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}
    HostEnd(const HostEnd&) = delete;
    HostEnd& operator=(const HostEnd&) = delete;
    ~HostEnd() {
        if (descriptor_ >= 0) {
            ::close(descriptor_);
        }
    }

    // Raw, and with nothing left in it. False, with errno, if that cannot be had.
    [[nodiscard]] bool make_fresh() const {
        termios settings{};
        if (descriptor_ < 0 || ::tcgetattr(descriptor_, &settings) != 0) {
            return false;
        }
        ::cfmakeraw(&settings);
        return ::tcsetattr(descriptor_, TCSANOW, &settings) == 0 &&
               ::tcflush(descriptor_, TCIOFLUSH) == 0;
    }

private:
    int descriptor_;
};

}  // namespace

Pty::Pty(asio::posix::stream_descriptor descriptor, std::string port)
    : descriptor_(std::move(descriptor))
    , port_(std::move(port)) {}

Result<Pty, Problem> Pty::open(const asio::any_io_executor& executor) {
    const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (master < 0) {
        return unavailable("posix_openpt", errno);
    }
    asio::posix::stream_descriptor descriptor(executor, master);  // closes it from here on
    if (::grantpt(master) != 0 || ::unlockpt(master) != 0) {
        return unavailable("unlockpt", errno);
    }
    std::array<char, 64> name{};
    if (const int failure = ::ptsname_r(master, name.data(), name.size()); failure != 0) {
        return unavailable("ptsname", failure);
    }
    const std::string port(name.data());
    if (::chmod(port.c_str(), S_IRUSR | S_IWUSR) != 0 || !HostEnd(port).make_fresh()) {
        return unavailable(port, errno);
    }
    return Pty(std::move(descriptor), port);
}

Pty::Received Pty::read_some(std::span<std::uint8_t> into) {
    ssize_t count = -1;
    do {
        count = ::read(descriptor_.native_handle(), into.data(), into.size());
    } while (count < 0 && errno == EINTR);
    if (count >= 0) {
        return {.bytes = static_cast<std::size_t>(count), .host_present = count > 0};
    }
    // EIO says that nobody has the other end open, and that all it had written has been read.
    return {.bytes = 0, .host_present = errno == EAGAIN};
}

std::size_t Pty::write_some(std::span<const std::uint8_t> bytes) {
    std::size_t written = 0;
    while (written < bytes.size()) {
        const auto rest = bytes.subspan(written);
        const auto count = ::write(descriptor_.native_handle(), rest.data(), rest.size());
        if (count > 0) {
            written += static_cast<std::size_t>(count);
        } else if (count == 0 || errno != EINTR) {
            break;
        }
    }
    return written;
}

asio::awaitable<void> Pty::readable() {
    co_await descriptor_.async_wait(asio::posix::stream_descriptor::wait_read, asio::use_awaitable);
}

void Pty::clean_up_after_host() {
    // Nothing depends on it: at worst the next host finds stale bytes, as after any open of a real
    // port.
    (void)HostEnd(port_).make_fresh();
}

}  // namespace sweepcast::virtual_lidar
