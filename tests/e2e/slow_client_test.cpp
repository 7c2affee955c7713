// A client that stops reading: it costs bounded memory, and no other client notices it.
#include "server/frame/message_framing.hpp"
#include "tests/e2e/gateway.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace sweepcast::test {
namespace {

namespace asio = boost::asio;

/// The kernel holds at most so many bytes for one client: twice what its buffer was set to.
constexpr std::size_t kernel_share = 256UL * 1024;
/// The bound of a mailbox.
constexpr std::size_t mailbox_frames = 8;
/// So many bytes of frames are more than the kernel and a mailbox hold.
constexpr std::size_t more_than_fits = kernel_share * 3 / 2;

/// The newest sweep of each lidar.
using Newest = std::map<std::string, std::uint64_t>;

bool is_frame(const v1::ServerMessage& message) {
    return message.has_frame();
}

/// Asks for uncompressed frames and reads none unless told to. Its receive buffer is as small as
/// the kernel allows. Frames of one `farthest_mm` are not shared with clients that give another.
class StalledClient {
public:
    StalledClient(const std::string& address, double farthest_mm) {
        const auto colon = address.rfind(':');
        socket_.open(asio::ip::tcp::v4());
        socket_.set_option(asio::socket_base::receive_buffer_size(1));
        socket_.connect(
            {asio::ip::make_address(address.substr(0, colon)),
             static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1)))}
        );
        v1::ClientMessage message;
        message.mutable_subscribe()->set_compression(v1::NONE);
        message.mutable_subscribe()->set_max_distance_mm(farthest_mm);
        const auto text = message.SerializeAsString();
        std::vector<std::uint8_t> bytes;
        frame::append_delimited(bytes, std::vector<std::uint8_t>(text.begin(), text.end()));
        asio::write(socket_, asio::buffer(bytes));
    }

    /// Reads until a frame comes that is newer than `newest`; returns those before it.
    std::vector<v1::Frame> read_up_to(const Newest& newest) {
        std::vector<v1::Frame> frames;
        std::array<std::uint8_t, 65536> chunk{};
        for (;;) {
            const auto got = socket_.read_some(asio::buffer(chunk));
            reader_.push(std::span(chunk).first(got));
            for (auto next = reader_.next(); next && *next; next = reader_.next()) {
                v1::ServerMessage message;
                message.ParseFromArray((*next)->data(), static_cast<int>((*next)->size()));
                const auto& frame = message.frame();
                if (is_frame(message) && frame.sequence() > newest.at(frame.lidar())) {
                    return frames;
                }
                if (is_frame(message)) {
                    frames.push_back(frame);
                }
            }
        }
    }

private:
    asio::io_context context_;
    asio::ip::tcp::socket socket_{context_};
    frame::DelimitedReader reader_{1U << 20U};
};

/// Reads frames of so many bytes together and expects none to be missing.
Newest read_without_gap(Subscriber& reader, std::size_t bytes) {
    Newest newest;
    for (std::size_t read = 0; read < bytes;) {
        const auto message = reader.next(is_frame);
        const auto& frame = message.frame();
        const auto [known, is_first] = newest.try_emplace(frame.lidar(), frame.sequence());
        if (!is_first) {
            EXPECT_EQ(frame.sequence(), known->second + 1) << "the reader missed a sweep";
            known->second = frame.sequence();
        }
        read += message.ByteSizeLong();
    }
    return newest;
}

/// A gateway with lidars that send much, and a client that reads all of it.
struct BusyGateway {
    BusyGateway() {
        reader.subscribe("", false);
        reader.next(is_frame);
    }
    GatewayProcess gateway{{"--lidar", "virtual:s2", "--lidar", "virtual:s2"}};
    Subscriber reader{"tcp://" + gateway.tcp};
};

TEST(SlowClient, ThatReadsAgainGetsNoMoreThanTheKernelsShareAndAMailbox) {
    BusyGateway busy;
    StalledClient stalled(busy.gateway.tcp, 100'000);
    const auto frames = stalled.read_up_to(read_without_gap(busy.reader, more_than_fits));

    Newest before;
    std::size_t in_kernel = 0;
    std::size_t bytes_in_kernel = 0;
    for (; in_kernel < frames.size(); ++in_kernel) {
        const auto& frame = frames[in_kernel];
        const auto [known, is_first] = before.try_emplace(frame.lidar(), frame.sequence());
        if (!is_first && frame.sequence() != known->second + 1) {
            break;  // some were dropped here
        }
        known->second = frame.sequence();
        bytes_in_kernel += frame.ByteSizeLong();
    }
    ASSERT_LT(in_kernel, frames.size()) << "no frame was dropped";
    EXPECT_LE(bytes_in_kernel, kernel_share);
    EXPECT_LE(frames.size() - in_kernel, mailbox_frames);
}

TEST(SlowClient, ThatNeverReadsDelaysNobodyAndCostsBoundedMemory) {
    // Where AddressSanitizer is built in, it would keep what the gateway gives back.
    setenv("ASAN_OPTIONS", "quarantine_size_mb=1:thread_local_quarantine_size_kb=64", 1);
    BusyGateway busy;
    constexpr int count = 16;
    std::vector<std::unique_ptr<StalledClient>> stalled;
    for (int i = 0; i < count; ++i) {
        stalled.push_back(std::make_unique<StalledClient>(busy.gateway.tcp, 100'000.0 + i));
    }
    read_without_gap(busy.reader, more_than_fits);  // the mailboxes are full
    const auto full = busy.gateway.process.resident_bytes();
    read_without_gap(busy.reader, kernel_share);
    const auto later = busy.gateway.process.resident_bytes();
    // Each has missed as many bytes again, of frames that no other client has.
    EXPECT_LT(later, full + count * kernel_share / 2);
}

}  // namespace
}  // namespace sweepcast::test
