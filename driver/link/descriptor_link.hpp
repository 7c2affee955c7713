// DescriptorLink: a Link over an open file descriptor, normally a terminal: a serial port or a pty.
#pragma once

#include "driver/link/path_watch.hpp"
#include "driver/link/transport_link.hpp"

#include <boost/asio/posix/stream_descriptor.hpp>

#include <memory>
#include <string>

namespace sweepcast::link {

/// Moves bytes through a descriptor that does not block. The descriptor itself is closed on another
/// thread, in `lane` (see async::run_blocking): what was not sent yet may keep that waiting.
class DescriptorTransport {
public:
    DescriptorTransport(boost::asio::posix::stream_descriptor descriptor, std::string lane)
        : descriptor_(std::move(descriptor))
        , lane_(std::move(lane)) {}

    boost::asio::any_io_executor executor() { return descriptor_.get_executor(); }
    [[nodiscard]] bool is_open() const { return descriptor_.is_open(); }
    [[nodiscard]] int fd() { return descriptor_.native_handle(); }
    boost::asio::awaitable<Transferred> read_some(std::span<std::uint8_t> into);
    boost::asio::awaitable<Transferred> write_some(std::span<const std::uint8_t> bytes);
    std::size_t read_now(std::span<std::uint8_t> into);
    void cancel();
    void close();

private:
    boost::asio::posix::stream_descriptor descriptor_;
    std::string lane_;
};

class DescriptorLink final : public TransportLink<DescriptorTransport> {
public:
    /// Takes over `descriptor`, of the device file `node`, whose terminal settings are made
    /// already: a read must wait for at least one byte (VMIN 1), since one that gives none counts
    /// as a hang-up. Once the device file has vanished, the link closes itself: operations end with
    /// errc::disconnected.
    DescriptorLink(
        boost::asio::posix::stream_descriptor descriptor,
        const std::string& node,
        std::uint32_t baud
    );

    Result<void> set_dtr(bool asserted) override;
    Result<void> set_baud(std::uint32_t baud) override;
    [[nodiscard]] std::uint32_t baud() const override { return baud_; }
    [[nodiscard]] bool is_network() const override { return false; }
    void close() override;

private:
    void look_for_node();

    std::uint32_t baud_;
    std::unique_ptr<PathWatch> watch_;  ///< while the link is open
};

}  // namespace sweepcast::link
