// The steps of opening a serial port: open, lock, configure, hand over.
#include "driver/link/serial_link.hpp"

#include "driver/async/blocking.hpp"
#include "driver/link/descriptor_link.hpp"
#include "driver/link/device_node.hpp"
#include "driver/link/open_problem.hpp"
#include "driver/link/port_holder.hpp"
#include "driver/link/termios2.hpp"

#include <boost/asio/posix/stream_descriptor.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <functional>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>
#include <utility>

namespace sweepcast::link {

namespace {

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

/// Whether `path` may be a terminal, for all that can be told without opening it.
bool may_be_terminal(const std::string& path) {
    constexpr unsigned memory_devices = 1;  // /dev/null and the like, which many have open
    struct stat found {};
    return ::stat(path.c_str(), &found) == 0 && S_ISCHR(found.st_mode) &&
           major(found.st_rdev) != memory_devices;
}

/// Whether another process competes for `path`, as far as we may see. Looked at twice: one that
/// only passes by does not count.
bool held_by_another(const std::string& path) {
    const auto others = [&path] {
        auto holders = find_port_competitors(path);
        std::erase_if(holders, [](const auto& holder) { return holder.pid == ::getpid(); });
        return holders;
    };
    const auto first = others();
    if (first.empty()) {
        return false;
    }
    const auto second = others();
    return std::ranges::any_of(second, [&](const auto& holder) {
        return std::ranges::find(first, holder) != first.end();
    });
}

/// A port that is open and set, and the device file that it is.
struct OpenPort {
    OwnedDescriptor fd;
    std::string node;
};

Result<OpenPort, Problem> open_port(const std::string& path, std::uint32_t baud) {
    if (baud == 0) {
        return explain_baud(path, 0, 0);
    }
    // Not opened to find out: that would assert DTR, and so stop the motor of another one's A1.
    if (may_be_terminal(path) && held_by_another(path)) {
        return explain(path, EBUSY);
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
    return OpenPort{std::move(fd), device_node(path)};
}

Result<std::unique_ptr<Link>, Problem> make_link(
    const boost::asio::any_io_executor& executor,
    const std::string& path,
    std::uint32_t baud,
    OpenPort port
) {
    boost::asio::posix::stream_descriptor descriptor(executor);
    error_code ec;
    descriptor.assign(port.fd.get(), ec);
    if (ec) {
        return explain(path, ec.value());
    }
    (void)port.fd.release();  // the descriptor owns it now
    return std::unique_ptr<Link>(
        std::make_unique<DescriptorLink>(std::move(descriptor), port.node, baud)
    );
}

Problem explain_hang(const std::string& path) {
    return {
        errc::timed_out,
        fmt::format("opening {} hangs: its driver does not answer", path),
        "unplug the adapter and plug it in again; see whether `dmesg` says more about it"};
}

}  // namespace

boost::asio::awaitable<Result<std::unique_ptr<Link>, Problem>> open_serial(
    boost::asio::any_io_executor executor,
    std::string path,
    std::uint32_t baud,
    Deadline deadline
) {
    using Tried = Result<OpenPort, Problem>;
    std::function<Tried()> open = [path, baud] { return open_port(path, baud); };
    auto lane = device_node(path);
    auto opened = co_await async::run_blocking<Tried>(std::move(lane), deadline, std::move(open));
    if (!opened) {
        co_return explain_hang(path);
    }
    if (!*opened) {
        co_return opened->error();
    }
    co_return make_link(executor, path, baud, std::move(**opened));
}

Result<std::unique_ptr<Link>, Problem> open_serial_now(
    const boost::asio::any_io_executor& executor,
    const std::string& path,
    std::uint32_t baud
) {
    auto opened = open_port(path, baud);
    if (!opened) {
        return opened.error();
    }
    return make_link(executor, path, baud, std::move(*opened));
}

}  // namespace sweepcast::link
