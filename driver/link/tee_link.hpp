// TeeLink: a link that lets someone look on at all that passes over it.
#pragma once

#include "driver/link/link.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace sweepcast::link {

/// Who looks on. Called on the link's thread while an operation completes; must not block for long.
class LinkTap {
public:
    virtual ~LinkTap() = default;
    /// These bytes have just come from the device.
    virtual void on_read(std::span<const std::uint8_t> bytes) = 0;
    /// These bytes are about to be sent to the device.
    virtual void on_write(std::span<const std::uint8_t> bytes) = 0;
    /// The line has another speed from here on.
    virtual void on_set_baud(std::uint32_t baud) = 0;
};

/// Does all that the link within does. What is told of a write comes before whatever answers it; if
/// the write fails, part of it may not have been sent.
class TeeLink final : public Link {
public:
    /// `tap` outlives this.
    TeeLink(std::unique_ptr<Link> inner, LinkTap& tap);

    [[nodiscard]] boost::asio::awaitable<Result<std::size_t>>
    read_some(std::span<std::uint8_t> into, Deadline deadline) override;
    [[nodiscard]] boost::asio::awaitable<Result<void>>
    write_all(std::span<const std::uint8_t> bytes, Deadline deadline) override;
    void interrupt() override { inner_->interrupt(); }
    Result<void> set_dtr(bool asserted) override { return inner_->set_dtr(asserted); }
    Result<void> set_baud(std::uint32_t baud) override;
    void flush_input() override { inner_->flush_input(); }
    [[nodiscard]] std::uint32_t baud() const override { return inner_->baud(); }
    [[nodiscard]] bool is_network() const override { return inner_->is_network(); }
    void close() override { inner_->close(); }

private:
    std::unique_ptr<Link> inner_;
    LinkTap& tap_;
};

}  // namespace sweepcast::link
