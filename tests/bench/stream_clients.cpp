#include "tests/bench/stream_clients.hpp"

#include "server/frame/message_framing.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <vector>

namespace sweepcast::bench {

namespace {

using Bytes = std::span<const std::uint8_t>;
using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const char* what) {
    throw std::system_error(errno, std::generic_category(), what);
}

enum class What : std::uint32_t { connect, read, do_not_read, tell, wait };

}  // namespace

struct StreamClients::Order {
    What what{};
    Kind kind{};
    std::uint32_t group{};
    std::uint32_t count{};
    std::uint32_t receive_buffer{};
    std::uint64_t sequence{};
    std::uint64_t limit_ms{};
    std::uint16_t port{};
};

namespace {

/// One message's place in a stream of them.
struct Place {
    std::size_t header{};
    std::size_t size{};
    std::uint8_t opcode{};
};

constexpr std::uint8_t binary = 0x82;
constexpr std::uint8_t ping = 0x89;

/// Where the first message is, if all of its header is there.
bool find_websocket(Bytes bytes, Place& place) {
    if (bytes.size() < 2) {
        return false;
    }
    place = {2, bytes[1], bytes[0]};
    const std::size_t more = bytes[1] == 126 ? 2 : (bytes[1] == 127 ? 8 : 0);
    if (bytes.size() < 2 + more) {
        return false;
    }
    if (more > 0) {
        place.size = 0;
        for (std::size_t i = 0; i < more; ++i) {
            place.size = place.size << 8U | bytes[2 + i];
        }
        place.header += more;
    }
    return true;
}

bool find_delimited(Bytes bytes, Place& place) {
    place = {0, 0, binary};
    for (unsigned shift = 0; place.header < bytes.size(); shift += 7) {
        const auto byte = bytes[place.header++];
        place.size |= std::size_t{byte & 0x7FU} << shift;
        if (byte < 0x80) {
            return true;
        }
    }
    return false;
}

struct Client {
    int socket{-1};
    std::uint32_t group{};
    Kind kind{};
    bool shaken{};
    std::vector<std::uint8_t> waiting;  // of a message that is not whole
    std::uint64_t frames{}, first{}, last{}, missed{}, told{};
    std::uint32_t out_of_order{};
};

class ClientLoop {
public:
    explicit ClientLoop(int control) : control_(control), epoll_(epoll_create1(EPOLL_CLOEXEC)) {
        watch(control_, 0);
    }

    void run() {
        std::vector<epoll_event> events(1024);
        for (;;) {
            const int ready = epoll_wait(
                epoll_,
                events.data(),
                static_cast<int>(events.size()),
                waits_ ? 10 : -1
            );
            for (const auto& event :
                 std::span(events).first(static_cast<std::size_t>(std::max(ready, 0)))) {
                if (event.data.u64 > 0) {
                    read(*clients_[event.data.u64 - 1]);
                } else if (!obey()) {
                    return;
                }
            }
            answer_wait();
        }
    }

private:
    void watch(int descriptor, std::uint64_t name) const {
        epoll_event event{};
        event.events = EPOLLIN;
        event.data.u64 = name;
        epoll_ctl(epoll_, EPOLL_CTL_ADD, descriptor, &event);
    }

    /// False when the benchmark has ended.
    bool obey() {
        if (recv(control_, &order_, sizeof order_, 0) != sizeof order_) {
            return false;
        }
        switch (order_.what) {
        case What::connect:
            for (std::uint32_t i = 0; i < order_.count; ++i) {
                connect();
            }
            break;
        case What::read:
        case What::do_not_read:
            for (std::size_t i = 0; i < clients_.size(); ++i) {
                const auto& client = *clients_[i];
                if (client.group == order_.group && client.socket >= 0) {
                    if (order_.what == What::read) {
                        watch(client.socket, i + 1);
                    } else {
                        epoll_ctl(epoll_, EPOLL_CTL_DEL, client.socket, nullptr);
                    }
                }
            }
            break;
        case What::tell:
            break;
        case What::wait:
            waits_ = true;
            give_up_ = Clock::now() + std::chrono::milliseconds(order_.limit_ms);
            return true;
        }
        answer();
        return true;
    }

    void answer_wait() {
        if (waits_ && (sum().least_last >= order_.sequence || Clock::now() > give_up_)) {
            waits_ = false;
            answer();
        }
    }

    void answer() const {
        const auto seen = sum();
        (void)send(control_, &seen, sizeof seen, 0);  // if it cannot be sent, nobody listens
    }

    [[nodiscard]] Seen sum() const {
        Seen seen;
        seen.least_last = UINT64_MAX;
        for (const auto& client : clients_) {
            if (client->group == order_.group) {
                seen.connected += client->socket >= 0 ? 1U : 0U;
                seen.frames += client->frames;
                seen.missed += client->missed;
                seen.told += client->told;
                seen.told_wrong += client->told != client->missed ? 1U : 0U;
                seen.out_of_order += client->out_of_order;
                seen.least_last = std::min(seen.least_last, client->last);
            }
        }
        return seen;
    }

    void connect() {
        auto client = std::make_unique<Client>();
        client->group = order_.group;
        client->kind = order_.kind;
        client->shaken = order_.kind != Kind::websocket;
        client->socket = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (client->socket < 0) {
            fail("cannot open a socket");
        }
        if (order_.receive_buffer > 0) {
            const int size = static_cast<int>(order_.receive_buffer);
            setsockopt(client->socket, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
        }
        const int at_once = 1;
        setsockopt(client->socket, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(order_.port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const auto* any = static_cast<const sockaddr*>(static_cast<const void*>(&address));
        if (::connect(client->socket, any, sizeof address) != 0) {
            fail("cannot connect");
        }
        const auto wish = first_words(order_.kind);
        if (send(client->socket, wish.data(), wish.size(), MSG_NOSIGNAL) !=
            static_cast<ssize_t>(wish.size())) {
            fail("cannot subscribe");
        }
        clients_.push_back(std::move(client));
        watch(clients_.back()->socket, clients_.size());
    }

    static std::string first_words(Kind kind) {
        if (kind == Kind::websocket) {
            return "GET /api/v1/stream?kind=sweep HTTP/1.1\r\nHost: localhost\r\n"
                   "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                   "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: "
                   "13\r\n\r\n";
        }
        if (kind == Kind::bare) {
            return "";
        }
        v1::ClientMessage message;
        message.mutable_subscribe();
        const auto bytes = message.SerializeAsString();
        return std::string(1, static_cast<char>(bytes.size())) + bytes;
    }

    void read(Client& client) {
        const auto got = recv(client.socket, space_.data(), space_.size(), MSG_DONTWAIT);
        if (got < 0 && (errno == EAGAIN || errno == EINTR)) {
            return;
        }
        if (got <= 0) {
            close(client.socket);
            client.socket = -1;
            return;
        }
        Bytes bytes(space_.data(), static_cast<std::size_t>(got));
        if (!client.waiting.empty()) {
            client.waiting.insert(client.waiting.end(), bytes.begin(), bytes.end());
            bytes = client.waiting;
        }
        const auto left = take(client, bytes);
        const std::vector<std::uint8_t> rest(left.begin(), left.end());
        client.waiting.assign(rest.begin(), rest.end());
    }

    /// Takes the messages that are whole; what is left.
    Bytes take(Client& client, Bytes bytes) {
        if (!client.shaken) {
            constexpr std::string_view end = "\r\n\r\n";
            const auto found = std::search(bytes.begin(), bytes.end(), end.begin(), end.end());
            if (found == bytes.end()) {
                return bytes;
            }
            client.shaken = true;
            bytes = Bytes(found + static_cast<std::ptrdiff_t>(end.size()), bytes.end());
        }
        Place place;
        const auto find = client.kind == Kind::tcp ? find_delimited : find_websocket;
        while (find(bytes, place) && bytes.size() >= place.header + place.size) {
            const auto message = bytes.subspan(place.header, place.size);
            if (place.opcode == binary) {
                take_message(client, message);
            } else if (place.opcode == ping) {
                const std::array<std::uint8_t, 6> pong{0x8A, 0x80, 0, 0, 0, 0};
                (void)send(client.socket, pong.data(), pong.size(), MSG_NOSIGNAL);  // else cut off
            }
            bytes = bytes.subspan(place.header + place.size);
        }
        return bytes;
    }

    void take_message(Client& client, Bytes bytes) {
        if (!message_.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
            ++client.out_of_order;
            return;
        }
        if (message_.has_stats()) {
            client.told = message_.stats().frames_dropped();
        }
        if (!message_.has_frame()) {
            return;
        }
        const auto sequence = message_.frame().sequence();
        if (client.last > 0) {
            client.out_of_order += sequence <= client.last ? 1U : 0U;
            client.missed += sequence > client.last ? sequence - client.last - 1 : 0;
        }
        client.last = std::max(client.last, sequence);
        ++client.frames;
    }

    int control_;
    int epoll_;
    StreamClients::Order order_;
    bool waits_{};
    Clock::time_point give_up_;
    std::vector<std::unique_ptr<Client>> clients_;
    std::vector<std::uint8_t> space_ = std::vector<std::uint8_t>(1U << 18U);
    v1::ServerMessage message_;
};

}  // namespace

StreamClients::StreamClients() {
    std::array<int, 2> ends{};
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
        fail("no pair of sockets");
    }
    control_ = ends[0];
    process_ = fork();
    if (process_ < 0) {
        fail("cannot start the clients");
    }
    if (process_ > 0) {
        close(ends[1]);
        return;
    }
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    close(ends[0]);
    try {
        allow_many_files();
        ClientLoop(ends[1]).run();
    } catch (const std::exception& e) {
        std::fprintf(stderr, "the clients: %s\n", e.what());
        _exit(1);
    }
    _exit(0);
}

StreamClients::~StreamClients() {
    close(control_);
    waitpid(process_, nullptr, 0);
}

std::uint32_t StreamClients::connect(
    Kind kind,
    std::uint16_t port,
    std::uint32_t count,
    std::uint32_t receive_buffer
) {
    static std::uint32_t groups = 0;
    Order order;
    order.what = What::connect;
    order.kind = kind;
    order.group = ++groups;
    order.count = count;
    order.receive_buffer = receive_buffer;
    order.port = port;
    ask(order);
    return order.group;
}

void StreamClients::set_reading(std::uint32_t group, bool reads) {
    Order order;
    order.what = reads ? What::read : What::do_not_read;
    order.group = group;
    ask(order);
}

Seen StreamClients::seen(std::uint32_t group) {
    Order order;
    order.what = What::tell;
    order.group = group;
    return ask(order);
}

bool StreamClients::wait_for(std::uint32_t group, std::uint64_t sequence, double limit_s) {
    Order order;
    order.what = What::wait;
    order.group = group;
    order.sequence = sequence;
    order.limit_ms = static_cast<std::uint64_t>(limit_s * 1000);
    return ask(order).least_last >= sequence;
}

Seen StreamClients::ask(const Order& order) {
    Seen seen;
    if (send(control_, &order, sizeof order, MSG_NOSIGNAL) != sizeof order ||
        recv(control_, &seen, sizeof seen, 0) != sizeof seen) {
        throw std::runtime_error("the clients have ended");
    }
    return seen;
}

void allow_many_files() {
    rlimit limit{};
    getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
}

std::size_t resident_bytes() {
    std::ifstream file("/proc/self/statm");
    std::size_t all = 0;
    std::size_t resident = 0;
    file >> all >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace sweepcast::bench
