// DescriptorLink: a Link over an open file descriptor, normally a terminal: a serial port or a pty.
#pragma once

#include "driver/link/deadline_timer.hpp"
#include "driver/link/link.hpp"

#include <boost/asio/posix/stream_descriptor.hpp>

namespace sweepcast::link {

class DescriptorLink final : public Link {
public:
    /// Takes over `descriptor`, whose terminal settings are made already: a read must wait for at
    /// least one byte (VMIN 1), since one that gives none counts as a hang-up.
    DescriptorLink(boost::asio::posix::stream_descriptor descriptor, std::uint32_t baud);
    ~DescriptorLink() override;

    [[nodiscard]] boost::asio::awaitable<Result<std::size_t>>
    read_some(std::span<std::uint8_t> into, Deadline deadline) override;
    [[nodiscard]] boost::asio::awaitable<Result<void>>
    write_all(std::span<const std::uint8_t> bytes, Deadline deadline) override;
    void interrupt() override;
    Result<void> set_dtr(bool asserted) override;
    void flush_input() override;
    [[nodiscard]] std::uint32_t baud() const override { return baud_; }
    void close() override;

private:
    /// Reading or writing: at most one operation of it is under way.
    struct Direction {
        DeadlineTimer timer;
        bool pending{};
        bool interrupted{};
    };
    class Operation;

    /// A deadline or an interrupt ends whatever is pending on the descriptor; the operation that
    /// was not meant begins again, which loses nothing.
    void cancel_pending();

    /// The last look after a deadline: bytes that came before it may not have been announced yet
    /// (the kernel hands them to a terminal's reader in the background, and this thread may have
    /// been busy). Errors: errc::timed_out if there are none.
    Result<std::size_t> read_what_is_there(std::span<std::uint8_t> into);

    boost::asio::posix::stream_descriptor descriptor_;
    std::uint32_t baud_;
    Direction reading_;
    Direction writing_;
};

}  // namespace sweepcast::link
