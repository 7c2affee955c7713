// Serial links on real pseudo-terminals.
#include "driver/link/serial_link.hpp"

#include "driver/link/error.hpp"
#include "tests/driver/link/pty_pair.hpp"
#include "tests/driver/link/scratch_directory.hpp"

#include <boost/asio/bind_cancellation_slot.hpp>
#include <boost/asio/cancellation_signal.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <optional>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <vector>

namespace sweepcast::link {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

Deadline in(std::chrono::milliseconds delay) {
    return std::chrono::steady_clock::now() + delay;
}

/// A read or write that was started; its result once it has ended.
template <class T>
struct Pending {
    std::optional<Result<T>> result;
    asio::cancellation_signal cancel;
};

class SerialLinkTest : public testing::Test {
protected:
    static constexpr std::uint32_t baud = 115200;

    std::unique_ptr<Link> open(const std::string& path) {
        auto opened = open_serial(context_.get_executor(), path, baud);
        if (!opened) {
            throw std::runtime_error(opened.error().cause);
        }
        return std::move(*opened);
    }

    Problem open_badly(const std::string& path) {
        auto opened = open_serial(context_.get_executor(), path, baud);
        if (opened) {
            throw std::runtime_error(path + " should not have opened");
        }
        return opened.error();
    }

    /// Starts a read; it is pending, or has ended, when this returns.
    void start_read(Pending<std::size_t>& read, std::span<std::uint8_t> into, Deadline deadline) {
        start(read, link_->read_some(into, deadline));
    }

    template <class T>
    void start(Pending<T>& operation, asio::awaitable<Result<T>> work) {
        spawn(operation, std::move(work));
        context_.restart();
        context_.poll();
    }

    template <class T>
    void spawn(Pending<T>& operation, asio::awaitable<Result<T>> work) {
        asio::co_spawn(
            context_,
            std::move(work),
            asio::bind_cancellation_slot(
                operation.cancel.slot(),
                [&operation](const std::exception_ptr& failure, Result<T> result) {
                    if (!failure) {
                        operation.result = result;
                    }
                }
            )
        );
    }

    /// Waits until it has ended, at most ten seconds.
    template <class T>
    Result<T> finish(Pending<T>& operation) {
        context_.restart();
        while (!operation.result && context_.run_one_for(10s) != 0) {
        }
        return operation.result.value();
    }

    Result<std::size_t> read(std::span<std::uint8_t> into, Deadline deadline) {
        Pending<std::size_t> operation;
        start_read(operation, into, deadline);
        return finish(operation);
    }

    Result<void> write(std::span<const std::uint8_t> bytes, Deadline deadline) {
        Pending<void> operation;
        start(operation, link_->write_all(bytes, deadline));
        return finish(operation);
    }

    /// Reads until `count` bytes are there.
    Bytes read_exactly(std::size_t count) {
        Bytes bytes(count);
        std::size_t have = 0;
        while (have < count) {
            have += read(std::span(bytes).subspan(have), in(10s)).value();
        }
        return bytes;
    }

    static Bytes every_byte() {
        Bytes bytes(256);
        std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
        return bytes;
    }

    asio::io_context context_;
    PtyPair pty_;
    std::unique_ptr<Link> link_ = open(pty_.path());
    std::array<std::uint8_t, 64> buffer_{};
};

TEST_F(SerialLinkTest, ReadsEveryByteValueUnchanged) {
    pty_.send(every_byte());
    EXPECT_EQ(read_exactly(256), every_byte());
}

TEST_F(SerialLinkTest, WritesEveryByteValueUnchanged) {
    ASSERT_FALSE(write(every_byte(), in(10s)).has_error());
    Bytes received;
    while (received.size() < 256) {
        const Bytes more = pty_.receive(256);
        received.insert(received.end(), more.begin(), more.end());
    }
    EXPECT_EQ(received, every_byte());
}

TEST_F(SerialLinkTest, EndsAPendingReadWhenBytesCome) {
    Pending<std::size_t> operation;
    start_read(operation, buffer_, in(10s));
    EXPECT_FALSE(operation.result.has_value());
    pty_.send(Bytes{0xA5, 0x5A});
    EXPECT_EQ(finish(operation).value(), 2U);
    EXPECT_EQ(buffer_[0], 0xA5);
    EXPECT_EQ(buffer_[1], 0x5A);
}

TEST_F(SerialLinkTest, ReadsOneByteAtATimeInOrder) {
    pty_.send(Bytes{1, 2, 3});
    Bytes bytes;
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(read(std::span(buffer_).first(1), in(10s)).value(), 1U);
        bytes.push_back(buffer_[0]);
    }
    EXPECT_EQ(bytes, (Bytes{1, 2, 3}));
}

TEST_F(SerialLinkTest, ReadsNothingIntoNothing) {
    EXPECT_EQ(read({}, in(10s)).value(), 0U);
}

TEST_F(SerialLinkTest, GivesUpReadingAtTheDeadline) {
    EXPECT_EQ(read(buffer_, in(2ms)).error(), errc::timed_out);
}

TEST_F(SerialLinkTest, DeliversWhatIsThereAlthoughTheDeadlineHasPassed) {
    pty_.send(Bytes{7});
    EXPECT_EQ(read(buffer_, in(-1ms)).value(), 1U);
    EXPECT_EQ(read(buffer_, in(-1ms)).error(), errc::timed_out);
}

TEST_F(SerialLinkTest, DeliversBytesThatCameTogetherWithTheDeadline) {
    Pending<std::size_t> operation;
    const auto deadline = in(1ms);
    spawn(operation, link_->read_some(buffer_, deadline));
    context_.run_one();  // begins to read, without a look at the clock
    pty_.send(Bytes{7});
    while (std::chrono::steady_clock::now() < deadline) {
    }
    EXPECT_EQ(finish(operation).value(), 1U);
}

TEST_F(SerialLinkTest, LosesNothingOverManyDeadlines) {
    Bytes received;
    std::uint8_t next = 0;
    while (received.size() < 200) {
        Pending<std::size_t> operation;
        start_read(operation, buffer_, in(next % 3 == 0 ? 0ms : 1ms));
        pty_.send(Bytes{next++});
        if (const auto count = finish(operation)) {
            received.insert(
                received.end(),
                buffer_.begin(),
                buffer_.begin() + static_cast<int>(*count)
            );
        } else {
            ASSERT_EQ(count.error(), errc::timed_out);
        }
    }
    Bytes expected(received.size());
    std::iota(expected.begin(), expected.end(), std::uint8_t{0});
    EXPECT_EQ(received, expected);
}

TEST_F(SerialLinkTest, InterruptsAPendingRead) {
    Pending<std::size_t> operation;
    start_read(operation, buffer_, in(10s));
    link_->interrupt();
    EXPECT_EQ(finish(operation).error(), errc::interrupted);
}

TEST_F(SerialLinkTest, InterruptsTheNextReadIfNoneIsPending) {
    link_->interrupt();
    pty_.send(Bytes{7});
    EXPECT_EQ(read(buffer_, in(10s)).error(), errc::interrupted);
    EXPECT_EQ(read(buffer_, in(10s)).value(), 1U) << "an interrupt counts once";
}

TEST_F(SerialLinkTest, InterruptsTheReadAfterOneThatGotItsBytesAtThatMoment) {
    Pending<std::size_t> operation;
    pty_.send(Bytes{7});
    spawn(operation, link_->read_some(buffer_, in(10s)));
    // One handler at a time until the read has its bytes in hand but has not resumed.
    context_.run_one();
    ASSERT_FALSE(operation.result.has_value());
    link_->interrupt();
    EXPECT_EQ(finish(operation).value(), 1U);
    EXPECT_EQ(read(buffer_, in(10s)).error(), errc::interrupted);
}

TEST_F(SerialLinkTest, AnInterruptDuringAWriteIsKeptForTheNextRead) {
    const Bytes much(1 << 16, 0x55);
    Pending<void> writing;
    start(writing, link_->write_all(much, in(10s)));
    ASSERT_FALSE(writing.result.has_value()) << "nobody reads the other end";
    link_->interrupt();
    std::size_t received = 0;
    while (received < much.size()) {
        received += pty_.receive(much.size()).size();
        context_.restart();
        context_.poll();
    }
    EXPECT_FALSE(finish(writing).has_error());
    pty_.send(Bytes{7});
    EXPECT_EQ(read(buffer_, in(10s)).error(), errc::interrupted);
    EXPECT_EQ(read(buffer_, in(10s)).value(), 1U);
}

TEST_F(SerialLinkTest, GivesUpWritingAtTheDeadline) {
    const Bytes much(1 << 20, 0x55);
    EXPECT_EQ(write(much, in(2ms)).error(), errc::timed_out);
}

TEST_F(SerialLinkTest, KeepsWritingWhileTheDeadlineOfAReadPasses) {
    const Bytes much(1 << 16, 0x55);
    Pending<void> writing;
    start(writing, link_->write_all(much, in(10s)));
    ASSERT_FALSE(writing.result.has_value());
    EXPECT_EQ(read(buffer_, in(1ms)).error(), errc::timed_out);
    ASSERT_FALSE(writing.result.has_value());
    std::size_t received = 0;
    while (received < much.size()) {
        received += pty_.receive(much.size()).size();
        context_.restart();
        context_.poll();
    }
    EXPECT_FALSE(finish(writing).has_error());
    EXPECT_EQ(received, much.size());
}

TEST_F(SerialLinkTest, CancellationOfTheCoroutineEndsAPendingRead) {
    Pending<std::size_t> operation;
    start_read(operation, buffer_, in(10s));
    operation.cancel.emit(asio::cancellation_type::terminal);
    EXPECT_EQ(finish(operation).error(), errc::interrupted);
}

TEST_F(SerialLinkTest, ReportsAHangUpDuringARead) {
    Pending<std::size_t> operation;
    start_read(operation, buffer_, in(10s));
    pty_.hang_up();
    EXPECT_EQ(finish(operation).error(), errc::disconnected);
}

TEST_F(SerialLinkTest, ReportsAHangUpToReadsAndWritesAndDtr) {
    pty_.hang_up();
    EXPECT_EQ(read(buffer_, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(write(Bytes{7}, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(link_->set_dtr(true).error(), errc::disconnected);
}

TEST_F(SerialLinkTest, SaysThatAPtyHasNoModemLines) {
    EXPECT_EQ(link_->set_dtr(true).error(), errc::no_modem_lines);
    EXPECT_EQ(link_->set_dtr(false).error(), errc::no_modem_lines);
}

TEST_F(SerialLinkTest, FlushesWhatHasArrived) {
    pty_.send(Bytes{1, 2, 3});
    link_->flush_input();
    pty_.send(Bytes{4});
    ASSERT_EQ(read(buffer_, in(10s)).value(), 1U);
    EXPECT_EQ(buffer_[0], 4);
}

TEST_F(SerialLinkTest, ClosingEndsAPendingReadAndRefusesLaterOnes) {
    Pending<std::size_t> operation;
    start_read(operation, buffer_, in(10s));
    link_->close();
    EXPECT_EQ(finish(operation).error(), errc::interrupted);
    link_->close();
    EXPECT_EQ(read(buffer_, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(write(Bytes{7}, in(10s)).error(), errc::disconnected);
    EXPECT_EQ(link_->set_dtr(true).error(), errc::disconnected);
    link_->flush_input();
    link_->interrupt();
}

TEST_F(SerialLinkTest, NamesThisProcessWhenThePortIsAlreadyOurs) {
    const Problem problem = open_badly(pty_.path());
    EXPECT_EQ(problem.code, errc::port_busy);
    EXPECT_THAT(problem.cause, HasSubstr(pty_.path() + " is in use"));
    EXPECT_THAT(problem.cause, HasSubstr("(" + std::to_string(::getpid()) + ")"));
}

TEST_F(SerialLinkTest, OpensAgainOnceClosed) {
    link_->close();
    EXPECT_TRUE(open_serial(context_.get_executor(), pty_.path(), baud).has_value());
}

TEST_F(SerialLinkTest, MakesThePortExclusiveUntilItIsClosed) {
    const int other = ::open(pty_.path().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);  // only root may
    int exclusive = 0;
    if (other >= 0) {
        ASSERT_EQ(::ioctl(other, TIOCGEXCL, &exclusive), 0);
        EXPECT_EQ(exclusive, 1);
        link_->close();
        ASSERT_EQ(::ioctl(other, TIOCGEXCL, &exclusive), 0);
        EXPECT_EQ(exclusive, 0);
        ::close(other);
    } else {
        EXPECT_EQ(errno, EBUSY);
    }
}

TEST_F(SerialLinkTest, KnowsItsBaudRate) {
    EXPECT_EQ(link_->baud(), 115200U);
}

TEST_F(SerialLinkTest, SaysThatThereIsNoSuchPort) {
    const Problem problem = open_badly("/dev/ttyUSB_none");
    EXPECT_EQ(problem.code, errc::port_not_found);
    EXPECT_EQ(problem.cause, "there is no port /dev/ttyUSB_none");
    EXPECT_THAT(problem.hint, HasSubstr("USB serial port"));
}

TEST_F(SerialLinkTest, SaysWhatAPathIsThatIsNoSerialPort) {
    const ScratchDirectory scratch;
    const std::string file = scratch.file("notes.txt", "hello").string();
    EXPECT_EQ(open_badly(file).code, errc::not_a_serial_port);
    EXPECT_EQ(open_badly(file).cause, file + " is a regular file, not a serial port");
    EXPECT_EQ(
        open_badly(scratch.root().string()).cause,
        scratch.root().string() + " is a directory, not a serial port"
    );
    EXPECT_EQ(open_badly("/dev/null").cause, "/dev/null is not a serial port");
}

TEST_F(SerialLinkTest, RefusesABaudRateOfZero) {
    link_->close();
    const auto opened = open_serial(context_.get_executor(), pty_.path(), 0);
    ASSERT_TRUE(opened.has_error());
    EXPECT_EQ(opened.error().code, errc::baud_not_supported);
}

TEST_F(SerialLinkTest, LeavesNoDescriptorBehindWhenItCannotOpen) {
    const int before = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::close(before);
    (void)open_badly("/dev/null");
    (void)open_badly(pty_.path());
    const int after = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    ::close(after);
    EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace sweepcast::link
