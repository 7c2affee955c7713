// A thousand clients, over WebSocket and TCP, of which fifty stop reading for a while: the others
// miss nothing, memory stays bounded, and the fifty are told exactly what they missed. Exit status
// 0 if it is so.
#include "tests/bench/beat.hpp"
#include "tests/bench/stream_clients.hpp"
#include "tests/bench/stream_server.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <string>

namespace sweepcast::bench {
namespace {

constexpr unsigned hz = 10;
/// In four seconds, more than the kernel's buffers and a mailbox take.
constexpr std::size_t frame_size = 24'000;
constexpr std::uint32_t small_receive_buffer = 4096;
constexpr double patience_s = 30;
/// Beyond what the frames in the mailboxes take, which all share.
constexpr std::size_t most_growth = 8UL * 1024 * 1024;

struct Check {
    StreamClients clients;
    StreamServer server{2};
    std::uint64_t sequence{};
    bool passed{true};

    void expect(bool holds, const std::string& what) {
        fmt::print("{} {}\n", holds ? "ok    " : "FAILED", what);
        passed = passed && holds;
    }

    void publish(unsigned seconds) {
        Beat beat(hz);
        for (unsigned i = 0; i < seconds * hz; ++i) {
            beat.wait();
            server.publish(make_frame(++sequence, frame_size));
        }
    }

    std::uint32_t connect(Kind kind, std::uint32_t count, std::uint32_t receive_buffer) {
        const auto port = kind == Kind::websocket ? server.http_port() : server.tcp_port();
        return clients.connect(kind, port, count, receive_buffer);
    }

    void expect_nothing_missed(std::uint32_t group, const char* name) {
        const bool all_there = clients.wait_for(group, sequence, patience_s);
        const auto seen = clients.seen(group);
        expect(
            all_there && seen.missed == 0 && seen.told == 0 && seen.out_of_order == 0,
            fmt::format("{}: {} frames, {} missed", name, seen.frames, seen.missed)
        );
    }

    void expect_told(std::uint32_t group, const char* name) {
        const bool all_there = clients.wait_for(group, sequence, patience_s);
        auto seen = clients.seen(group);
        Beat beat(hz);  // the last count comes within a second
        for (unsigned i = 0; i < patience_s * hz && seen.told_wrong > 0; ++i) {
            beat.wait();
            seen = clients.seen(group);
        }
        expect(
            all_there && seen.missed > 0 && seen.told_wrong == 0 && seen.out_of_order == 0,
            fmt::format(
                "{}: {} missed, told of {}; {} clients told wrong",
                name,
                seen.missed,
                seen.told,
                seen.told_wrong
            )
        );
    }
};

int run(unsigned seconds, std::uint32_t count, std::uint32_t stalled) {
    Check check;
    const std::array reading{
        check.connect(Kind::websocket, (count - stalled) / 2, 0),
        check.connect(Kind::tcp, (count - stalled) / 2, 0)};
    const std::array stalling{
        check.connect(Kind::websocket, stalled / 2, small_receive_buffer),
        check.connect(Kind::tcp, stalled / 2, small_receive_buffer)};
    for (Beat beat(100); check.server.subscribers() < count / 2 * 2;) {
        beat.wait();
    }
    check.publish(1);
    for (const auto group : stalling) {
        check.clients.set_reading(group, false);
    }
    const auto before = resident_bytes();
    check.publish(seconds);
    const auto after = resident_bytes();
    const auto grown = after - std::min(before, after);
    check.expect(
        grown < most_growth,
        fmt::format("memory grew by {} kB in {} s of stall", grown / 1024, seconds)
    );
    for (const auto group : stalling) {
        check.clients.set_reading(group, true);
    }
    check.publish(2);
    check.expect_nothing_missed(reading[0], "WebSocket clients that read");
    check.expect_nothing_missed(reading[1], "TCP clients that read");
    check.expect_told(stalling[0], "WebSocket clients that stopped");
    check.expect_told(stalling[1], "TCP clients that stopped");
    return check.passed ? 0 : 1;
}

}  // namespace
}  // namespace sweepcast::bench

int main(int count, char** arguments) {
    unsigned seconds = 60;
    std::uint32_t clients = 1000;
    std::uint32_t stalled = 50;
    CLI::App app("Clients that stop reading, and those that do not");
    app.add_option("--seconds", seconds, "of stall");
    app.add_option("--clients", clients);
    app.add_option("--stalled", stalled, "how many of them");
    CLI11_PARSE(app, count, arguments);
    sweepcast::bench::allow_many_files();
    return sweepcast::bench::run(seconds, clients, stalled);
}
