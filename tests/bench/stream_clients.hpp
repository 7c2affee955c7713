// The clients of the stream's benchmarks: a process of its own with one epoll loop, so that what
// they cost is not counted as the server's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <sys/types.h>

namespace sweepcast::bench {

enum class Kind : std::uint32_t {
    websocket,  ///< subscribes by its URL
    tcp,        ///< says what it wants, gets delimited messages
    bare,       ///< says nothing, gets WebSocket frames
};

/// What a group of clients has seen.
struct Seen {
    std::uint32_t connected{};     ///< still open
    std::uint64_t frames{};        ///< received, by all together
    std::uint64_t missed{};        ///< gaps in their sequences, by all together
    std::uint64_t told{};          ///< what StreamStats said of that, by all together
    std::uint32_t told_wrong{};    ///< clients that were told another number than they missed
    std::uint32_t out_of_order{};  ///< frames that came late or twice
    std::uint64_t least_last{};    ///< the least of their last sequence numbers
};

/// Start it before any thread. Every call throws if the clients cannot do it.
class StreamClients {
public:
    StreamClients();
    /// Ends the clients.
    ~StreamClients();
    StreamClients(const StreamClients&) = delete;
    StreamClients& operator=(const StreamClients&) = delete;

    /// Connects so many to a port of this machine. `receive_buffer` in bytes; 0: the kernel's
    /// usual. The group's number.
    std::uint32_t
    connect(Kind kind, std::uint16_t port, std::uint32_t count, std::uint32_t receive_buffer = 0);
    /// Has a group read or not.
    void set_reading(std::uint32_t group, bool reads);
    [[nodiscard]] Seen seen(std::uint32_t group);
    /// Waits until each of the group has received the frame with this number. False if that takes
    /// longer than `limit_s` seconds.
    bool wait_for(std::uint32_t group, std::uint64_t sequence, double limit_s);

    /// What the process is told to do.
    struct Order;

private:
    Seen ask(const Order& order);

    pid_t process_{-1};
    int control_{-1};
};

/// Raises this process's limit of open files as far as it may.
void allow_many_files();

/// Resident memory of this process, in bytes.
[[nodiscard]] std::size_t resident_bytes();

}  // namespace sweepcast::bench
