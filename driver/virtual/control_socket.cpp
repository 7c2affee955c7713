#include "driver/virtual/control_socket.hpp"

#include "driver/virtual/error.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include <optional>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace asio = boost::asio;
using asio::local::stream_protocol;
using namespace std::chrono_literals;

namespace {

constexpr std::size_t longest_path = sizeof(sockaddr_un::sun_path) - 1;

Problem unavailable(const std::string& path, std::string_view why, std::string hint) {
    return {errc::control_unavailable, fmt::format("{}: {}", path, why), std::move(hint)};
}

std::optional<Problem> check_path(const std::string& path) {
    if (path.empty() || path.size() > longest_path) {
        return unavailable(
            path,
            "cannot be the path of a control socket",
            fmt::format("choose a path of 1 to {} bytes, e.g. /tmp/lidar.control", longest_path)
        );
    }
    return std::nullopt;
}

// The inode of the socket at `path`; none if there is no socket.
std::optional<ino_t> socket_at(const std::string& path) {
    struct stat found {};
    if (::lstat(path.c_str(), &found) != 0 || !S_ISSOCK(found.st_mode)) {
        return std::nullopt;
    }
    return found.st_ino;
}

// Whether the process that made the socket at `path` is gone.
bool is_left_over(const asio::any_io_executor& executor, const std::string& path) {
    if (!socket_at(path)) {
        return false;
    }
    stream_protocol::socket probe(executor);
    error_code failed;
    probe.connect(stream_protocol::endpoint(path), failed);
    return failed == asio::error::connection_refused;
}

// Opens, binds and makes it private; it does not listen yet.
error_code bind_to(stream_protocol::acceptor& acceptor, const std::string& path) {
    error_code failed;
    acceptor.open(stream_protocol(), failed);
    if (!failed) {
        acceptor.bind(stream_protocol::endpoint(path), failed);
    }
    return failed;
}

}  // namespace

Result<std::unique_ptr<ControlSocket>, Problem>
ControlSocket::open(asio::any_io_executor executor, std::string path, Answer answer) {
    if (auto problem = check_path(path)) {
        return std::move(*problem);
    }
    stream_protocol::acceptor acceptor(executor);
    auto failed = bind_to(acceptor, path);
    if (failed == asio::error::address_in_use && is_left_over(executor, path)) {
        ::unlink(path.c_str());
        error_code ignored;  // a new one is opened in its place
        acceptor.close(ignored);
        failed = bind_to(acceptor, path);
    }
    if (failed == asio::error::address_in_use) {
        return unavailable(
            path,
            socket_at(path) ? "is the control socket of another virtual lidar"
                            : "exists and is not a socket",
            "stop what uses it, or choose another path"
        );
    }
    if (!failed && ::chmod(path.c_str(), S_IRUSR | S_IWUSR) != 0) {
        failed.assign(errno, boost::system::system_category());
    }
    if (!failed) {
        acceptor.listen(asio::socket_base::max_listen_connections, failed);
    }
    const auto inode = socket_at(path);
    if (failed || !inode) {
        return unavailable(
            path,
            fmt::format("cannot make the control socket: {}", failed.message()),
            "choose a path in a folder that exists and that you may write to"
        );
    }
    return std::unique_ptr<ControlSocket>(new ControlSocket(
        std::move(executor),
        std::move(acceptor),
        std::move(path),
        *inode,
        std::move(answer)
    ));
}

ControlSocket::ControlSocket(
    asio::any_io_executor executor,
    Acceptor acceptor,
    std::string path,
    ino_t inode,
    Answer answer
)
    : executor_(std::move(executor))
    , acceptor_(std::move(acceptor))
    , path_(std::move(path))
    , inode_(inode)
    , answer_(std::move(answer)) {}

ControlSocket::~ControlSocket() {
    if (socket_at(path_) == inode_) {
        ::unlink(path_.c_str());
    }
}

asio::awaitable<void> ControlSocket::run() {
    // Cancelled, it ends by waiting for what it has spawned.
    co_await asio::this_coro::throw_if_cancelled(false);
    async::TaskGroup connections(executor_, [this](std::exception_ptr failure) {
        failure_ = std::move(failure);
        acceptor_.cancel();
    });
    asio::steady_timer next_try(executor_);
    while (!failure_) {
        error_code failed;
        auto socket =
            co_await acceptor_.async_accept(asio::redirect_error(asio::use_awaitable, failed));
        const auto state = co_await asio::this_coro::cancellation_state;
        if (state.cancelled() != asio::cancellation_type::none) {
            break;
        }
        if (failed) {  // for want of descriptors: the connection waits
            next_try.expires_after(100ms);
            co_await next_try.async_wait(asio::redirect_error(asio::use_awaitable, failed));
        } else if (connections.size() >= most_connections) {
            socket.non_blocking(true, failed);
            socket.write_some(
                asio::buffer(std::string_view("error: too many connections: close another\n")),
                failed
            );
        } else {
            connections.spawn(serve(std::make_shared<Socket>(std::move(socket))));
        }
    }
    connections.cancel();
    for (bool ended = false; !ended;) {
        ended = co_await connections.join(1s);
    }
    if (failure_) {
        std::rethrow_exception(failure_);
    }
}

asio::awaitable<void> ControlSocket::serve(std::shared_ptr<Socket> socket) {
    std::string received;
    asio::steady_timer idle(executor_);
    while (true) {
        idle.expires_after(idle_limit);
        idle.async_wait([socket](const error_code& cancelled) {
            if (!cancelled) {
                socket->cancel();
            }
        });
        error_code failed;
        co_await asio::async_read_until(
            *socket,
            asio::dynamic_buffer(received, longest_line + 1),
            '\n',
            asio::redirect_error(asio::use_awaitable, failed)
        );
        const bool too_long = failed == asio::error::not_found;
        // The last line may lack its end.
        const bool is_last = failed == asio::error::eof && !received.empty();
        if (failed && !too_long && !is_last) {
            co_return;
        }
        const auto end = std::min(received.find('\n'), received.size());
        std::string answer =
            too_long
                ? fmt::format("error: the line is too long: it has at most {} bytes", longest_line)
                : answer_(std::string_view(received).substr(0, end));
        answer += '\n';
        received.erase(0, end + 1);
        co_await asio::async_write(
            *socket,
            asio::buffer(answer),
            asio::redirect_error(asio::use_awaitable, failed)
        );
        if (failed || too_long || is_last) {
            co_return;
        }
    }
}

namespace {

asio::awaitable<void>
ask(stream_protocol::socket& socket, std::string request, std::string& received) {
    co_await asio::async_write(socket, asio::buffer(request), asio::use_awaitable);
    const auto size = co_await asio::async_read_until(
        socket,
        asio::dynamic_buffer(received, 64 * 1024),
        '\n',
        asio::use_awaitable
    );
    received.resize(size - 1);
}

}  // namespace

Result<std::string, Problem> ask_control_socket(const std::string& path, std::string_view line) {
    constexpr auto limit = 5s;
    if (auto problem = check_path(path)) {
        return std::move(*problem);
    }
    asio::io_context context(1);
    stream_protocol::socket socket(context);
    error_code failed;
    socket.connect(stream_protocol::endpoint(path), failed);
    if (failed) {
        return unavailable(
            path,
            fmt::format("cannot reach the virtual lidar: {}", failed.message()),
            "start one with sweepcast virtual --control " + path
        );
    }
    std::string received;
    bool answered = false;
    asio::co_spawn(
        context,
        ask(socket, std::string(line) + "\n", received),
        [&answered](const std::exception_ptr& failure) { answered = !failure; }
    );
    context.run_for(limit);
    if (!answered) {
        return unavailable(
            path,
            "the virtual lidar did not answer",
            "see what it writes to its log; it is perhaps busy, stopped, or just ended"
        );
    }
    return received;
}

}  // namespace sweepcast::virtual_lidar
