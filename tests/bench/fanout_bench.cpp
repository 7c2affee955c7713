// What it costs to give a frame to a client: the gateway's listener, sessions and hub, beside a
// bare loop that does nothing but send() the same bytes to as many sockets. Processor time of this
// process, per frame and client; the clients are another process and count every frame.
#include "server/stream/tcp_transport.hpp"
#include "tests/bench/beat.hpp"
#include "tests/bench/stream_clients.hpp"
#include "tests/bench/stream_server.hpp"

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace sweepcast::bench {
namespace {

struct Options {
    std::uint32_t clients{1000};
    std::size_t workers{1};
    unsigned seconds{3};
    unsigned rounds{5};
    unsigned hz{10};
    std::size_t size{3000};
};

/// Threads that wait for a frame in epoll and send() it to each of their sockets.
class BareSender {
public:
    explicit BareSender(std::size_t threads) : shares_(threads) {
        for (auto& share : shares_) {
            share.epoll = epoll_create1(EPOLL_CLOEXEC);
            share.doorbell = eventfd(0, EFD_CLOEXEC);
            watch(share, share.doorbell);
            share.thread = std::thread([this, &share] { run(share); });
        }
    }
    ~BareSender() {
        stops_ = true;
        ring();
        for (auto& share : shares_) {
            share.thread.join();
            for (const int socket : share.sockets) {
                close(socket);
            }
            close(share.doorbell);
            close(share.epoll);
        }
    }
    BareSender(const BareSender&) = delete;
    BareSender& operator=(const BareSender&) = delete;

    [[nodiscard]] std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

    /// Takes what has connected; before the first frame.
    void accept(std::uint32_t count) {
        for (std::uint32_t i = 0; i < count; ++i) {
            auto socket = acceptor_.accept();
            stream::set_stream_options(socket);
            auto& share = shares_[i % shares_.size()];
            share.sockets.push_back(socket.release());
            watch(share, share.sockets.back());
        }
    }

    void publish(const frame::WireMessagePtr& frame) {
        {
            const std::scoped_lock lock(mutex_);
            for (auto& share : shares_) {
                share.waiting.push_back(frame);
            }
        }
        ring();
    }

private:
    struct Share {
        int epoll{-1};
        int doorbell{-1};
        std::vector<int> sockets;
        std::vector<frame::WireMessagePtr> waiting;
        std::thread thread;
    };

    static void watch(const Share& share, int descriptor) {
        epoll_event event{};
        event.events = EPOLLIN | (descriptor == share.doorbell ? 0U : EPOLLET);
        event.data.fd = descriptor;
        epoll_ctl(share.epoll, EPOLL_CTL_ADD, descriptor, &event);
    }

    void ring() {
        for (const auto& share : shares_) {
            eventfd_write(share.doorbell, 1);
        }
    }

    void run(Share& share) {
        std::array<epoll_event, 64> events{};
        while (!stops_) {
            epoll_wait(share.epoll, events.data(), static_cast<int>(events.size()), -1);
            eventfd_t rings = 0;
            eventfd_read(share.doorbell, &rings);
            std::vector<frame::WireMessagePtr> frames;
            {
                const std::scoped_lock lock(mutex_);
                frames.swap(share.waiting);
            }
            for (const auto& frame : frames) {
                send_to_all(share, frame->framed(frame::Framing::websocket).head);
            }
        }
    }

    static void send_to_all(const Share& share, std::span<const std::uint8_t> bytes) {
        for (const int socket : share.sockets) {
            // What does not fit is lost, and then the clients miss it.
            (void)!send(socket, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        }
    }

    boost::asio::io_context context_;
    boost::asio::ip::tcp::acceptor acceptor_{
        context_,
        {boost::asio::ip::address_v4::loopback(), 0}};
    std::vector<Share> shares_;
    std::mutex mutex_;
    std::atomic<bool> stops_{};
};

/// Processor time in microseconds.
struct Cost {
    double user{};
    double system{};
    [[nodiscard]] double all() const { return user + system; }
};

Cost spent() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto microseconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) * 1e6 + static_cast<double>(time.tv_usec);
    };
    return {microseconds(usage.ru_utime), microseconds(usage.ru_stime)};
}

/// One way of sending, and the clients that it sends to.
struct Way {
    std::function<void(frame::WireMessagePtr)> publish;
    std::uint32_t group{};
    std::uint64_t sequence{};
    std::vector<Cost> costs;

    /// Publishes for a while; false if a client did not get a frame.
    bool measure(StreamClients& clients, const Options& options) {
        const auto before = spent();
        const auto frames = std::uint64_t{options.seconds} * options.hz;
        Beat beat(options.hz);
        for (std::uint64_t i = 0; i < frames; ++i) {
            beat.wait();
            publish(make_frame(++sequence, options.size));
        }
        constexpr double patience_s = 20;
        const bool all_there = clients.wait_for(group, sequence, patience_s);
        const auto after = spent();
        const auto deliveries = static_cast<double>(frames * options.clients);
        costs.push_back(
            {(after.user - before.user) / deliveries, (after.system - before.system) / deliveries}
        );
        return all_there;
    }

    [[nodiscard]] Cost median() const {
        auto sorted = costs;
        std::ranges::sort(sorted, {}, &Cost::all);
        return sorted[sorted.size() / 2];
    }
};

void print(const char* name, const Cost& cost) {
    fmt::print(
        "{:<14}{:6.2f} us ({:.2f} user + {:.2f} system)\n",
        name,
        cost.all(),
        cost.user,
        cost.system
    );
}

int run(const Options& options) {
    StreamClients clients;
    StreamServer server(options.workers);
    BareSender bare(options.workers);

    Way gateway;
    gateway.publish = [&](const auto& frame) { server.publish(frame); };
    gateway.group = clients.connect(Kind::websocket, server.http_port(), options.clients);
    Way loop;
    loop.publish = [&](const auto& frame) { bare.publish(frame); };
    std::thread accepting([&] { bare.accept(options.clients); });
    loop.group = clients.connect(Kind::bare, bare.port(), options.clients);
    accepting.join();
    for (Beat beat(100); server.subscribers() < options.clients;) {
        beat.wait();
    }

    bool all_there = true;
    for (unsigned round = 0; round <= options.rounds && all_there; ++round) {
        all_there = gateway.measure(clients, options) && loop.measure(clients, options);
        if (round == 0) {  // warms up
            gateway.costs.clear();
            loop.costs.clear();
        } else if (all_there) {
            fmt::print(
                "round {}: {:.2f} us, send() alone {:.2f} us\n",
                round,
                gateway.costs.back().all(),
                loop.costs.back().all()
            );
        }
    }
    const auto seen = clients.seen(gateway.group);
    const auto bare_seen = clients.seen(loop.group);
    const auto expected = std::uint64_t{options.clients} * gateway.sequence;
    if (!all_there || seen.frames != expected || bare_seen.missed > 0) {
        fmt::print(
            "the clients got {} of {} frames, and missed {} of send() alone\n",
            seen.frames,
            expected,
            bare_seen.missed
        );
        return 1;
    }
    fmt::print(
        "{} bytes at {} Hz to {} WebSocket clients, {} worker(s); median of {} rounds of {} s, a "
        "frame and client; all frames arrived\n",
        options.size,
        options.hz,
        options.clients,
        options.workers,
        options.rounds,
        options.seconds
    );
    print("gateway", gateway.median());
    print("send() alone", loop.median());
    fmt::print("ratio         {:6.2f}\n", gateway.median().all() / loop.median().all());
    return 0;
}

}  // namespace
}  // namespace sweepcast::bench

int main(int count, char** arguments) {
    sweepcast::bench::Options options;
    CLI::App app("What a frame costs for each client");
    app.add_option("--clients", options.clients);
    app.add_option("--workers", options.workers);
    app.add_option("--seconds", options.seconds, "of a round");
    app.add_option("--rounds", options.rounds);
    app.add_option("--hz", options.hz);
    app.add_option("--size", options.size, "of a frame, in bytes");
    CLI11_PARSE(app, count, arguments);
    sweepcast::bench::allow_many_files();
    return sweepcast::bench::run(options);
}
