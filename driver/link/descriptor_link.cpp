// Reading and writing a descriptor, and what a serial line has besides bytes: DTR and a speed.
#include "driver/link/descriptor_link.hpp"

#include "driver/async/blocking.hpp"
#include "driver/link/termios2.hpp"

#include <boost/asio/buffer.hpp>

#include <cerrno>
#include <exception>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace sweepcast::link {

namespace asio = boost::asio;

asio::awaitable<Transferred> DescriptorTransport::read_some(std::span<std::uint8_t> into) {
    return descriptor_.async_read_some(asio::buffer(into.data(), into.size()), as_awaitable_tuple);
}

asio::awaitable<Transferred> DescriptorTransport::write_some(std::span<const std::uint8_t> bytes) {
    return descriptor_.async_write_some(
        asio::buffer(bytes.data(), bytes.size()),
        as_awaitable_tuple
    );
}

std::size_t DescriptorTransport::read_now(std::span<std::uint8_t> into) {
    // Read also to throw away: tcflush() leaves behind what the kernel's line discipline has not
    // seen yet.
    const auto count = ::read(descriptor_.native_handle(), into.data(), into.size());
    return count > 0 ? static_cast<std::size_t>(count) : 0;
}

void DescriptorTransport::cancel() {
    error_code ignored;  // fails on a closed descriptor only, which has nothing pending
    descriptor_.cancel(ignored);
}

void DescriptorTransport::close() {
    const int fd = descriptor_.release();
    // From now on others may have it, and a pty that lives on in its other holders would stay
    // exclusive.
    (void)::ioctl(fd, TIOCNXCL);  // not a terminal: nothing to undo
    (void)::flock(fd, LOCK_UN);
    try {
        async::start_blocking(lane_, [fd] { ::close(fd); });
    } catch (const std::exception&) {  // no thread to be had
        ::close(fd);
    }
}

DescriptorLink::DescriptorLink(
    asio::posix::stream_descriptor descriptor,
    const std::string& node,
    std::uint32_t baud
)
    : TransportLink(DescriptorTransport(std::move(descriptor), node))
    , baud_(baud)
    , watch_(std::make_unique<PathWatch>(transport().executor(), node, [this] { look_for_node(); })
      ) {
    look_for_node();  // it may have vanished before it was watched
}

/// A device file that was removed has no name any more, whatever is at its path now.
void DescriptorLink::look_for_node() {
    struct stat node {};
    if (transport().is_open() && ::fstat(transport().fd(), &node) == 0 && node.st_nlink == 0) {
        watch_.reset();
        lose();
    }
}

void DescriptorLink::close() {
    watch_.reset();
    TransportLink::close();
}

Result<void> DescriptorLink::set_dtr(bool asserted) {
    if (!transport().is_open()) {
        return error_code(errc::disconnected);
    }
    const int line = TIOCM_DTR;
    if (::ioctl(transport().fd(), asserted ? TIOCMBIS : TIOCMBIC, &line) == 0) {
        return {};
    }
    // A pty has no ioctl for it (ENOTTY), a driver without modem lines says EINVAL.
    if (errno == ENOTTY || errno == EINVAL) {
        return error_code(errc::no_modem_lines);
    }
    return translate({errno, boost::system::system_category()});
}

Result<void> DescriptorLink::set_baud(std::uint32_t baud) {
    if (!transport().is_open()) {
        return error_code(errc::disconnected);
    }
    if (baud == 0) {  // would hang up the line
        return error_code(errc::baud_not_supported);
    }
    const auto actual = set_raw_8n1(transport().fd(), baud);
    if (!actual && actual.error().value() == ENOTTY) {
        return error_code(errc::no_line_speed);
    }
    if (!actual && actual.error().value() != EINVAL) {
        return translate(actual.error());
    }
    if (!actual || !close_enough(baud, *actual)) {
        if (const auto back = set_raw_8n1(transport().fd(), baud_); !back) {
            return translate(back.error());
        }
        return error_code(errc::baud_not_supported);
    }
    baud_ = baud;
    flush_input();
    return {};
}

}  // namespace sweepcast::link
