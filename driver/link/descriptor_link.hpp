// DescriptorLink: a Link over an open file descriptor, normally a terminal: a serial port or a pty.
#pragma once

#include "driver/link/transport_link.hpp"

#include <boost/asio/posix/stream_descriptor.hpp>

namespace sweepcast::link {

/// Moves bytes through a descriptor that does not block.
class DescriptorTransport {
public:
    explicit DescriptorTransport(boost::asio::posix::stream_descriptor descriptor)
        : descriptor_(std::move(descriptor)) {}

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
};

class DescriptorLink final : public TransportLink<DescriptorTransport> {
public:
    /// Takes over `descriptor`, whose terminal settings are made already: a read must wait for at
    /// least one byte (VMIN 1), since one that gives none counts as a hang-up.
    DescriptorLink(boost::asio::posix::stream_descriptor descriptor, std::uint32_t baud)
        : TransportLink(DescriptorTransport(std::move(descriptor)))
        , baud_(baud) {}

    Result<void> set_dtr(bool asserted) override;
    Result<void> set_baud(std::uint32_t baud) override;
    [[nodiscard]] std::uint32_t baud() const override { return baud_; }
    [[nodiscard]] bool is_network() const override { return false; }

private:
    std::uint32_t baud_;
};

}  // namespace sweepcast::link
