// Finding a host and connecting to it within one deadline, and what to say if that fails.
#include "driver/link/open_link.hpp"

#include "driver/async/notifier.hpp"
#include "driver/link/deadline_timer.hpp"
#include "driver/link/network_link.hpp"
#include "driver/link/serial_link.hpp"
#include "driver/link/transport_link.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/system/system_error.hpp>
#include <fmt/format.h>

#include <cerrno>
#include <utility>
#include <vector>

namespace sweepcast::link {

namespace asio = boost::asio;
using asio::ip::tcp;
using asio::ip::udp;

namespace {

using Opened = Result<std::unique_ptr<Link>, Problem>;

/// A look-up that goes on by itself: the system's resolver cannot be interrupted, only left alone.
template <class Protocol>
struct Lookup {
    explicit Lookup(const asio::any_io_executor& executor)
        : resolver(executor)
        , changed(executor) {}

    typename Protocol::resolver resolver;
    async::Notifier changed;
    bool ended{};
    error_code error;
    std::vector<typename Protocol::endpoint> endpoints;
};

/// The addresses of `host`. Errors: those of netdb; try_again if no name service answers in time.
template <class Protocol>
asio::awaitable<Result<std::vector<typename Protocol::endpoint>>> look_up(
    asio::any_io_executor executor,
    const std::string& host,
    std::uint16_t port,
    Deadline deadline
) {
    using Endpoints = std::vector<typename Protocol::endpoint>;
    error_code not_an_address;
    const auto address = asio::ip::make_address(host, not_an_address);
    if (!not_an_address) {
        co_return Endpoints{typename Protocol::endpoint(address, port)};
    }
    const auto lookup = std::make_shared<Lookup<Protocol>>(executor);
    lookup->resolver.async_resolve(
        host,
        std::to_string(port),
        Protocol::resolver::numeric_service,
        [lookup](const error_code& error, const typename Protocol::resolver::results_type& found) {
            lookup->ended = true;
            lookup->error = error;
            lookup->endpoints.assign(found.begin(), found.end());
            lookup->changed.notify();
        }
    );
    while (!lookup->ended) {
        const bool changed = co_await lookup->changed.wait_until(deadline);
        if (!changed) {
            co_return error_code(asio::error::host_not_found_try_again);
        }
    }
    if (lookup->error) {
        co_return lookup->error;
    }
    co_return std::move(lookup->endpoints);
}

/// Tries one address after the other. Errors: errc::timed_out, else that of the last address.
template <class Socket, class Endpoints>
asio::awaitable<error_code>
connect_within(Socket& socket, const Endpoints& endpoints, Deadline deadline) {
    DeadlineTimer timer(socket.get_executor(), [&socket] {
        error_code ignored;  // it is being given up
        socket.close(ignored);
    });
    timer.start(deadline);
    const auto [ec, endpoint] = co_await asio::async_connect(socket, endpoints, as_awaitable_tuple);
    if (timer.expired()) {
        co_return errc::timed_out;
    }
    if (ec == asio::error::operation_aborted) {
        throw boost::system::system_error(ec);  // the coroutine was cancelled
    }
    co_return ec;
}

/// A connected socket.
template <class Protocol>
asio::awaitable<Result<typename Protocol::socket>> connect(
    asio::any_io_executor executor,
    const std::string& host,
    std::uint16_t port,
    Deadline deadline
) {
    const auto endpoints = co_await look_up<Protocol>(executor, host, port, deadline);
    if (!endpoints) {
        co_return endpoints.error();
    }
    typename Protocol::socket socket(executor);
    const error_code failure = co_await connect_within(socket, *endpoints, deadline);
    if (failure) {
        co_return failure;
    }
    co_return std::move(socket);
}

asio::awaitable<Opened>
open_tcp(asio::any_io_executor executor, TcpPlace place, Deadline deadline) {
    auto socket = co_await connect<tcp>(executor, place.host, place.port, deadline);
    if (!socket) {
        co_return explain_connect_error("tcp", place.host, place.port, socket.error());
    }
    co_return make_tcp_link(std::move(*socket));
}

asio::awaitable<Opened>
open_udp(asio::any_io_executor executor, UdpPlace place, Deadline deadline) {
    auto socket = co_await connect<udp>(executor, place.host, place.port, deadline);
    if (!socket) {
        co_return explain_connect_error("udp", place.host, place.port, socket.error());
    }
    co_return make_udp_link(std::move(*socket));
}

/// The link error that stands for an error of look_up() or of connect(2).
error_code classify(const error_code& error) {
    if (error.category() == asio::error::get_netdb_category()) {
        return errc::host_not_found;
    }
    if (error.category() != boost::system::system_category()) {
        return error;
    }
    switch (error.value()) {
    case ECONNREFUSED:
    case ECONNRESET:
        return errc::connection_refused;
    case EHOSTUNREACH:
    case ENETUNREACH:
    case EHOSTDOWN:
    case ENETDOWN:
    case EADDRNOTAVAIL:
        return errc::unreachable;
    case ETIMEDOUT:
        return errc::timed_out;
    default:
        return error;
    }
}

Problem explain_host_not_found(const std::string& host, const error_code& error) {
    if (error == asio::error::host_not_found_try_again) {
        return {
            errc::host_not_found,
            fmt::format("no name service told the address of {}", host),
            "write the address itself, such as 192.168.11.2, or check this machine's network"};
    }
    return {
        errc::host_not_found,
        fmt::format("there is no host {}", host),
        "check the name, or write the address itself, such as 192.168.11.2"};
}

}  // namespace

asio::awaitable<Opened> open_link(
    asio::any_io_executor executor,
    LinkUrl url,
    std::uint32_t baud,
    std::chrono::milliseconds limit
) {
    const Deadline deadline = std::chrono::steady_clock::now() + limit;
    if (const auto* serial = std::get_if<SerialPlace>(&url.where)) {
        co_return co_await open_serial(executor, serial->path, baud, deadline);
    }
    if (const auto* over_tcp = std::get_if<TcpPlace>(&url.where)) {
        co_return co_await open_tcp(executor, *over_tcp, deadline);
    }
    co_return co_await open_udp(executor, std::get<UdpPlace>(url.where), deadline);
}

Problem explain_connect_error(
    const std::string& scheme,
    const std::string& host,
    std::uint16_t port,
    const error_code& error
) {
    const bool is_ipv6 = host.find(':') != std::string::npos;
    const auto where =
        fmt::format("{}://{}{}{}:{}", scheme, is_ipv6 ? "[" : "", host, is_ipv6 ? "]" : "", port);
    const error_code code = classify(error);
    if (code == errc::host_not_found) {
        return explain_host_not_found(host, error);
    }
    if (code == errc::connection_refused) {
        return {
            code,
            fmt::format("nothing listens at {}", where),
            fmt::format(
                "{} is there, but not on this port: check the port of the serial bridge (usually "
                "{}), and that no one else is connected to it",
                host,
                default_tcp_port
            )};
    }
    if (code == errc::unreachable) {
        return {
            code,
            fmt::format("{} cannot be reached from here", where),
            fmt::format(
                "check that this machine has an address in the network of {}, and that the lidar "
                "has power",
                host
            )};
    }
    if (code == errc::timed_out) {
        return {
            code,
            fmt::format("{} did not answer in time", where),
            fmt::format(
                "check the address, the lidar's power and its network cable: does `ping {}` "
                "answer?",
                host
            )};
    }
    return {
        code,
        fmt::format("connecting to {} failed: {}", where, error.message()),
        "check the network of this machine"};
}

}  // namespace sweepcast::link
