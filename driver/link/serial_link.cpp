// The steps of opening a serial port: open, lock, configure, hand over.
#include "driver/link/serial_link.hpp"

#include "driver/link/descriptor_link.hpp"
#include "driver/link/open_problem.hpp"
#include "driver/link/termios2.hpp"

#include <boost/asio/posix/stream_descriptor.hpp>

#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>

namespace sweepcast::link {

namespace {

/// A descriptor that is closed again unless it is released.
class OwnedDescriptor {
public:
    explicit OwnedDescriptor(int fd) : fd_(fd) {}
    OwnedDescriptor(const OwnedDescriptor&) = delete;
    OwnedDescriptor& operator=(const OwnedDescriptor&) = delete;
    ~OwnedDescriptor() {
        if (fd_ >= 0) {
            ::close(fd_);
        }
    }
    [[nodiscard]] int get() const { return fd_; }
    int release() { return std::exchange(fd_, -1); }

private:
    int fd_;
};

Problem explain(const std::string& path, int error) {
    return explain_open_error(path, error, gather_port_facts(path));
}

/// Makes the port ours alone. Returns 0 or an errno value.
int lock(int fd) {
    // flock keeps out everyone who asks, root included; TIOCEXCL those who do not ask.
    if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
        return errno;
    }
    (void)::ioctl(fd, TIOCEXCL);  // not a terminal: set_raw_8n1 will say so
    return 0;
}

}  // namespace

Result<std::unique_ptr<Link>, Problem> open_serial(
    const boost::asio::any_io_executor& executor,
    const std::string& path,
    std::uint32_t baud
) {
    if (baud == 0) {
        return explain_baud(path, 0, 0);
    }
    OwnedDescriptor fd(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (fd.get() < 0) {
        return explain(path, errno);
    }
    if (::isatty(fd.get()) == 0) {
        return explain(path, errno);
    }
    if (const int error = lock(fd.get()); error != 0) {
        return explain(path, error);
    }
    const auto actual = set_raw_8n1(fd.get(), baud);
    if (!actual) {
        return explain(path, actual.error().value());
    }
    if (!close_enough(baud, *actual)) {
        return explain_baud(path, baud, *actual);
    }
    ask_for_low_latency(fd.get());
    boost::asio::posix::stream_descriptor descriptor(executor);
    error_code ec;
    descriptor.assign(fd.get(), ec);
    if (ec) {
        return explain(path, ec.value());
    }
    (void)fd.release();  // the descriptor owns it now
    return std::unique_ptr<Link>(std::make_unique<DescriptorLink>(std::move(descriptor), baud));
}

}  // namespace sweepcast::link
