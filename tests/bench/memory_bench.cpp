// What a subscriber costs in memory of the gateway's process (the kernel's buffers are not in it):
// one that is idle, beside a WebSocket session as Beast's examples write it, and one that does not
// read while frames come.
#include "tests/bench/bare_websockets.hpp"
#include "tests/bench/beat.hpp"
#include "tests/bench/stream_clients.hpp"
#include "tests/bench/stream_server.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdint>

namespace sweepcast::bench {
namespace {

constexpr double patience_s = 20;
constexpr std::size_t usual_size = 3000;
/// A stalled client's kernel buffers are full soon.
constexpr std::size_t big_size = 16'000;
constexpr std::uint32_t small_receive_buffer = 4096;

struct Bench {
    StreamClients clients;
    StreamServer server{1};
    std::uint64_t sequence{};

    /// Connects so many and waits until each has got a frame. The group's number.
    std::uint32_t connect(Kind kind, std::uint32_t count, std::uint32_t receive_buffer = 0) {
        const auto port = kind == Kind::websocket ? server.http_port() : server.tcp_port();
        const auto before = server.subscribers();
        const auto group = clients.connect(kind, port, count, receive_buffer);
        for (Beat beat(100); server.subscribers() < before + count;) {
            beat.wait();
        }
        server.publish(make_frame(++sequence, usual_size));
        if (!clients.wait_for(group, sequence, patience_s)) {
            throw std::runtime_error("a client got no frame");
        }
        return group;
    }

    /// Bytes that each of so many bare sessions takes.
    double bare(std::uint32_t count) {
        constexpr std::uint64_t only = 1;
        const BareWebsockets sessions(make_frame(only, usual_size));
        const auto greet = [&](std::uint32_t clients_more) {
            const auto group = clients.connect(Kind::websocket, sessions.port(), clients_more);
            if (!clients.wait_for(group, only, patience_s)) {
                throw std::runtime_error("a client got no frame");
            }
        };
        greet(count / 10);  // what all share
        const auto before = resident_bytes();
        greet(count);
        return (static_cast<double>(resident_bytes()) - static_cast<double>(before)) / count;
    }

    /// Bytes that each of so many takes.
    double idle(Kind kind, std::uint32_t count) {
        connect(kind, count / 10);  // what all share
        const auto before = resident_bytes();
        connect(kind, count);
        return (static_cast<double>(resident_bytes()) - static_cast<double>(before)) / count;
    }

    void stalled(std::uint32_t count) {
        const auto group = connect(Kind::websocket, count, small_receive_buffer);
        clients.set_reading(group, false);
        const auto before = resident_bytes();
        const hub::MailboxLimits limits;
        // The kernel takes some for each; then mailboxes fill; and then as many again.
        Beat beat(50);
        for (int i = 0; i < 100; ++i) {
            beat.wait();
            server.publish(make_frame(++sequence, big_size));
        }
        const auto grown = static_cast<double>(resident_bytes()) - static_cast<double>(before);
        fmt::print(
            "{} WebSocket clients that do not read: {:.0f} bytes each, {:.2f} MB in all (up to {} "
            "frames of {} bytes wait for each, {:.0f} MB if each had its own)\n",
            count,
            grown / count,
            grown / 1e6,
            limits.frames,
            big_size,
            static_cast<double>(limits.frames * big_size * count) / 1e6
        );
    }
};

int run(std::uint32_t clients) {
    Bench bench;
    // Before the bare ones, whose memory would be used again.
    const auto websocket = bench.idle(Kind::websocket, clients);
    const auto tcp = bench.idle(Kind::tcp, clients);
    const auto bare = bench.bare(clients);
    fmt::print(
        "an idle WebSocket subscriber: {:.0f} bytes, over TCP {:.0f}; a bare Beast session: "
        "{:.0f}; "
        "ratios {:.2f}, {:.2f}\n",
        websocket,
        tcp,
        bare,
        websocket / bare,
        tcp / bare
    );
    bench.stalled(clients / 2);
    return 0;
}

}  // namespace
}  // namespace sweepcast::bench

int main(int count, char** arguments) {
    std::uint32_t clients = 2000;
    CLI::App app("What a subscriber costs in memory");
    app.add_option("--clients", clients);
    CLI11_PARSE(app, count, arguments);
    sweepcast::bench::allow_many_files();
    return sweepcast::bench::run(clients);
}
