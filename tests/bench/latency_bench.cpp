// How long after the last byte of a packet was handed to the gateway its samples are at a client:
// as a sector, and as the sweep that it completes. An S2 (800 packets a second) behind a pseudo
// terminal, the real gateway, one TCP client of each kind; then with others beside them that take
// every sweep. Usage: latency_bench [SECONDS [OTHERS]]
#include "server/frame/frame_decoder.hpp"
#include "server/frame/message_framing.hpp"
#include "sweepcast/v1/stream.pb.h"
#include "tests/bench/pty_relay.hpp"
#include "tests/e2e/gateway.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <netinet/in.h>
#include <stdexcept>
#include <string>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace sweepcast::bench {
namespace {

using namespace std::chrono_literals;
using Microseconds = std::chrono::duration<double, std::micro>;

constexpr auto samples_per_packet = protocol::samples_per_packet(protocol::AnswerType::dense);
constexpr std::size_t turns_per_second = 10;
/// Left out at the beginning: the motor's start, and the joining of the others.
constexpr auto settling = 1s;

int connect_to(const std::string& address) {
    const auto colon = address.rfind(':');
    sockaddr_in where{};
    where.sin_family = AF_INET;
    where.sin_port = htons(static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1))));
    ::inet_pton(AF_INET, address.substr(0, colon).c_str(), &where.sin_addr);
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr general{};
    std::copy_n(
        static_cast<const char*>(static_cast<const void*>(&where)),
        sizeof where,
        static_cast<char*>(static_cast<void*>(&general))
    );
    if (socket < 0 || ::connect(socket, &general, sizeof where) != 0) {
        throw std::runtime_error("cannot connect to " + address);
    }
    return socket;
}

void subscribe(int socket, v1::Kind kind) {
    v1::ClientMessage message;
    auto& wish = *message.mutable_subscribe();
    wish.set_kind(kind);
    if (kind == v1::SECTOR) {
        wish.set_max_latency_ms(0.1);  // whatever a read brings
    }
    const auto bytes = message.SerializeAsString();
    std::vector<std::uint8_t> framed;
    frame::append_delimited(framed, std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
    if (::send(socket, framed.data(), framed.size(), MSG_NOSIGNAL) !=
        static_cast<ssize_t>(framed.size())) {
        throw std::runtime_error("cannot subscribe");
    }
}

struct Arrival {
    Clock::time_point at;
    std::uint64_t sequence{};
    bool last{};
    std::size_t samples{};
};

/// Reads frames from a connection of its own until told to end, and notes when each was there.
class MeasuredClient {
public:
    MeasuredClient(const std::string& address, v1::Kind kind) : socket_(connect_to(address)) {
        subscribe(socket_, kind);
        thread_ = std::thread([this] { run(); });
    }

    /// Waits until so many frames have come, but no longer than `limit`.
    void wait_for(std::size_t count, std::chrono::seconds limit) {
        std::unique_lock lock(mutex_);
        came_.wait_for(lock, limit, [&] { return arrivals_.size() >= count; });
    }

    /// Ends it and gives what came.
    const std::vector<Arrival>& finish() {
        ::shutdown(socket_, SHUT_RDWR);
        thread_.join();
        ::close(socket_);
        return arrivals_;
    }

private:
    void run() {
        frame::DelimitedReader reader(8U << 20U);
        frame::FrameDecoder decoder;
        v1::ServerMessage message;
        std::vector<std::uint8_t> chunk(256UL * 1024);
        for (;;) {
            const auto count = ::recv(socket_, chunk.data(), chunk.size(), 0);
            const auto now = Clock::now();
            if (count <= 0) {
                return;
            }
            reader.push(std::span(chunk).first(static_cast<std::size_t>(count)));
            for (auto bytes = reader.next(); bytes && *bytes; bytes = reader.next()) {
                message.ParseFromArray((*bytes)->data(), static_cast<int>((*bytes)->size()));
                if (!message.has_frame()) {
                    continue;
                }
                const auto& frame = message.frame();
                const auto scan = decoder.decode(frame);
                if (scan) {
                    const std::lock_guard lock(mutex_);
                    came_.notify_one();
                    arrivals_.push_back(
                        {now, frame.sequence(), frame.last(), scan->sweep.samples.size()}
                    );
                }
            }
        }
    }

    int socket_;
    std::mutex mutex_;
    std::condition_variable came_;
    std::vector<Arrival> arrivals_;
    std::thread thread_;
};

/// Clients that take every sweep and throw it away.
class Others {
public:
    Others(const std::string& address, std::size_t count) : epoll_(::epoll_create1(EPOLL_CLOEXEC)) {
        for (std::size_t i = 0; i < count; ++i) {
            const int socket = connect_to(address);
            subscribe(socket, v1::SWEEP);
            epoll_event event{};
            event.events = EPOLLIN;
            event.data.fd = socket;
            ::epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &event);
            sockets_.push_back(socket);
        }
        thread_ = std::thread([this] { run(); });
    }

    ~Others() {
        ended_ = true;
        thread_.join();
        for (const int socket : sockets_) {
            ::close(socket);
        }
        ::close(epoll_);
    }
    Others(const Others&) = delete;
    Others& operator=(const Others&) = delete;

private:
    void run() {
        std::vector<std::uint8_t> chunk(64UL * 1024);
        std::array<epoll_event, 256> events{};
        while (!ended_) {
            const int ready = ::epoll_wait(epoll_, events.data(), events.size(), 100);
            for (int i = 0; i < ready; ++i) {
                (void)::recv(
                    events[static_cast<std::size_t>(i)].data.fd,
                    chunk.data(),
                    chunk.size(),
                    MSG_DONTWAIT
                );
            }
        }
    }

    int epoll_;
    std::vector<int> sockets_;
    std::atomic<bool> ended_{false};
    std::thread thread_;
};

/// For each sector, by samples received: the packet after the one that its last sample is in, which
/// is what the decoder waits for.
struct Matched {
    std::vector<double> sectors_us;
    std::map<std::uint64_t, std::size_t> completed_by;  ///< sweep -> packet
};

/// The number of the packet that the first sector came with is not known: it is the last one that
/// no sector arrives before.
Matched match(const std::vector<Arrival>& sectors, const std::vector<Clock::time_point>& packets) {
    std::vector<std::size_t> after_first;  // packets from the first sector's on
    std::size_t samples = 0;
    for (const auto& sector : sectors) {
        samples += sector.samples;
        after_first.push_back((samples + samples_per_packet - 1) / samples_per_packet);
    }
    std::size_t base = packets.size();
    for (std::size_t i = 0; i < sectors.size(); ++i) {
        const auto sent =
            std::upper_bound(packets.begin(), packets.end(), sectors[i].at) - packets.begin();
        const auto before = static_cast<std::size_t>(sent);
        base = std::min(base, before > after_first[i] ? before - after_first[i] : 0);
    }
    Matched matched;
    const auto begin = sectors.front().at + settling;
    for (std::size_t i = 0; i < sectors.size(); ++i) {
        const auto packet = base + after_first[i] - 1;
        if (packet >= packets.size()) {
            continue;
        }
        if (sectors[i].last) {
            matched.completed_by[sectors[i].sequence] = packet;
        }
        if (sectors[i].at > begin) {
            matched.sectors_us.push_back(Microseconds(sectors[i].at - packets[packet]).count());
        }
    }
    return matched;
}

void print(const char* what, std::vector<double> us) {
    if (us.empty()) {
        fmt::print("  {:<8} nothing came\n", what);
        return;
    }
    std::sort(us.begin(), us.end());
    const auto at = [&](double part) {
        return us[std::min(
            us.size() - 1,
            static_cast<std::size_t>(part * static_cast<double>(us.size()))
        )];
    };
    fmt::print(
        "  {:<8} p50 {:7.0f} us   p99 {:7.0f} us   max {:7.0f} us   ({} frames)\n",
        what,
        at(0.5),
        at(0.99),
        us.back(),
        us.size()
    );
}

void measure(std::chrono::seconds length, std::size_t others) {
    test::VirtualLidarProcess lidar({"--model", "s2"});
    PtyRelay relay(lidar.port);
    test::GatewayProcess gateway({"--lidar", relay.path(), "--log-level", "error"});
    std::unique_ptr<Others> crowd;
    if (others > 0) {
        crowd = std::make_unique<Others>(gateway.tcp, others);
    }
    MeasuredClient sector_client(gateway.tcp, v1::SECTOR);
    MeasuredClient sweep_client(gateway.tcp, v1::SWEEP);
    const auto turns = static_cast<std::size_t>((length + settling).count()) * turns_per_second;
    sweep_client.wait_for(turns, 2 * length + 30s);
    const auto& sweeps = sweep_client.finish();
    const auto& sectors = sector_client.finish();
    fmt::print(
        "1 client of each kind{}\n",
        others > 0 ? fmt::format(", and {} others", others) : ""
    );
    if (sectors.empty()) {
        fmt::print("  no sector came\n");
        return;
    }
    const auto packets = relay.packets();
    const auto matched = match(sectors, packets);
    std::vector<double> sweeps_us;
    for (const auto& sweep : sweeps) {
        const auto found = matched.completed_by.find(sweep.sequence);
        if (found != matched.completed_by.end() && sweep.at > sectors.front().at + settling) {
            sweeps_us.push_back(Microseconds(sweep.at - packets[found->second]).count());
        }
    }
    print("sector", matched.sectors_us);
    print("sweep", sweeps_us);
}

void allow_many_sockets() {
    rlimit limit{};
    ::getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = limit.rlim_max;
    ::setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace
}  // namespace sweepcast::bench

int main(int argc, char** argv) {
    const std::chrono::seconds length(argc > 1 ? std::stoi(argv[1]) : 10);
    const std::size_t others = argc > 2 ? std::stoul(argv[2]) : 1000;
    sweepcast::bench::allow_many_sockets();
    sweepcast::bench::measure(length, 0);
    sweepcast::bench::measure(length, others);
    return 0;
}
