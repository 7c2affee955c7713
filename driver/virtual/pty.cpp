#include "driver/virtual/pty.hpp"

#include "driver/link/termios2.hpp"
#include "driver/virtual/error.hpp"

#include <boost/asio/use_awaitable.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
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
    explicit HostEnd(const std::string& path)
        : descriptor_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}
    HostEnd(const HostEnd&) = delete;
    HostEnd& operator=(const HostEnd&) = delete;
    ~HostEnd() {
        if (descriptor_ >= 0) {
            ::close(descriptor_);
        }
    }

    // Raw, at this speed, and with nothing left in it. False, with errno, if that cannot be had.
    [[nodiscard]] bool make_fresh(std::uint32_t baud) const {
        return descriptor_ >= 0 && link::set_raw_8n1(descriptor_, baud) &&
               ::tcflush(descriptor_, TCIOFLUSH) == 0;
    }

private:
    int descriptor_;
};

}  // namespace

Pty::Pty(asio::posix::stream_descriptor descriptor, std::string path)
    : descriptor_(std::move(descriptor))
    , next_look_(descriptor_.get_executor())
    , path_(std::move(path)) {}

Result<std::unique_ptr<Pty>, Problem>
Pty::open(const asio::any_io_executor& executor, std::uint32_t baud) {
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
    const std::string path(name.data());
    if (::chmod(path.c_str(), S_IRUSR | S_IWUSR) != 0 || !HostEnd(path).make_fresh(baud)) {
        return unavailable(path, errno);
    }
    return std::unique_ptr<Pty>(new Pty(std::move(descriptor), path));
}

HostPort::Received Pty::read_some(std::span<std::uint8_t> into) {
    ssize_t count = -1;
    do {
        count = ::read(descriptor_.native_handle(), into.data(), into.size());
    } while (count < 0 && errno == EINTR);
    // EIO says that nobody has the other end open, and that all it had written has been read.
    host_present_ = count > 0 || (count < 0 && errno == EAGAIN);
    return {
        .bytes = static_cast<std::size_t>(std::max<ssize_t>(count, 0)),
        .host_present = host_present_};
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

asio::awaitable<void> Pty::news() {
    // Nothing announces that a host has opened the port, so this is looked for.
    constexpr auto look_period = std::chrono::milliseconds(20);
    if (host_present_) {
        co_await descriptor_.async_wait(
            asio::posix::stream_descriptor::wait_read,
            asio::use_awaitable
        );
    } else {
        next_look_.expires_after(look_period);
        co_await next_look_.async_wait(asio::use_awaitable);
    }
}

void Pty::clean_up_after_host(std::uint32_t baud) {
    // Nothing depends on it: at worst the next host finds stale bytes, as after any open of a real
    // port.
    (void)HostEnd(path_).make_fresh(baud);
}

void Pty::close() {
    boost::system::error_code ignored;  // it is closed, whatever the system has to say to it
    descriptor_.close(ignored);
    next_look_.cancel();
}

std::uint32_t Pty::host_baud() const {
    // Asked at our end, the system tells of the other.
    const auto baud = link::line_speed(descriptor_.native_handle());
    return baud ? *baud : 0;
}

}  // namespace sweepcast::virtual_lidar
