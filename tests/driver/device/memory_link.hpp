// MemoryLink: a Link without a port. What the driver writes goes to a function, which may answer.
#pragma once

#include "driver/async/notifier.hpp"
#include "driver/link/link.hpp"

#include <boost/asio/any_io_executor.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace sweepcast::device {

/// The far end of a MemoryLink; outlives it, as a scanner outlives a connection.
struct Line {
    explicit Line(boost::asio::any_io_executor executor) : changed(std::move(executor)) {}

    /// Called with what the driver wrote.
    std::function<void(std::span<const std::uint8_t>)> on_write;
    /// The last DTR set by the driver: asserted or released.
    std::optional<bool> dtr;
    bool has_dtr{true};
    /// The speed the driver talks at; 0 makes it a network link.
    std::uint32_t baud{115200};

    /// Zeros come without end, faster than they are read.
    bool babbles{};
    /// Speeds that the adapter cannot run at.
    std::vector<std::uint32_t> refused_bauds;

    /// Sends bytes to the driver.
    void send(std::span<const std::uint8_t> bytes) {
        to_host.insert(to_host.end(), bytes.begin(), bytes.end());
        changed.notify();
    }
    /// Pulls the cable, for this connection.
    void unplug() {
        unplugged = true;
        changed.notify();
    }

    std::deque<std::uint8_t> to_host;
    bool unplugged{};
    bool interrupted{};
    async::Notifier changed;
};

class MemoryLink final : public link::Link {
public:
    explicit MemoryLink(Line& line);

    boost::asio::awaitable<Result<std::size_t>>
    read_some(std::span<std::uint8_t> into, link::Deadline deadline) override;
    boost::asio::awaitable<Result<void>>
    write_all(std::span<const std::uint8_t> bytes, link::Deadline deadline) override;
    void interrupt() override;
    Result<void> set_dtr(bool asserted) override;
    void flush_input() override { line_.to_host.clear(); }
    Result<void> set_baud(std::uint32_t baud) override;
    [[nodiscard]] std::uint32_t baud() const override { return line_.baud; }
    [[nodiscard]] bool is_network() const override { return line_.baud == 0; }
    void close() override {}

private:
    Line& line_;
};

}  // namespace sweepcast::device
