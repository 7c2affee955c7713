// Relay: stands between a program and a lidar on the network, and keeps what passes.
#pragma once

#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace sweepcast::test {

/// Passes the bytes of one connection, or datagrams of one host, on in both directions.
class Relay {
public:
    /// Before a lidar at "tcp://127.0.0.1:PORT" or "udp://127.0.0.1:PORT".
    explicit Relay(const std::string& lidar);
    ~Relay();
    Relay(const Relay&) = delete;
    Relay& operator=(const Relay&) = delete;

    /// Where the program is to look for the lidar.
    [[nodiscard]] const std::string& url() const { return url_; }

    struct Passed {
        std::vector<std::uint8_t> from_device, to_device;
    };
    /// Ends the relay and gives what it has passed on.
    Passed finish();

private:
    void run();
    bool pass(int from, int to, std::vector<std::uint8_t>& kept);

    bool is_udp_;
    std::string url_;
    int listener_{-1};  ///< of a datagram relay: what the host speaks to
    int device_{-1};
    int wake_[2]{-1, -1};
    Passed passed_;
    std::thread thread_;
};

}  // namespace sweepcast::test
