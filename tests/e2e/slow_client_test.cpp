// A client that stops reading: bounded memory, told what it missed, and nobody else notices.
#include "tests/e2e/gateway.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace sweepcast::test {
namespace {

namespace asio = boost::asio;

/// Asks for uncompressed frames and then never reads; its receive buffer is as small as the kernel
/// allows.
class NeverReads {
public:
    explicit NeverReads(const std::string& address) {
        const auto colon = address.rfind(':');
        socket_.open(asio::ip::tcp::v4());
        socket_.set_option(asio::socket_base::receive_buffer_size(1));
        socket_.connect(
            {asio::ip::make_address(address.substr(0, colon)),
             static_cast<std::uint16_t>(std::stoi(address.substr(colon + 1)))}
        );
        v1::ClientMessage message;
        message.mutable_subscribe()->set_compression(v1::NONE);
        auto bytes = message.SerializeAsString();
        bytes.insert(bytes.begin(), static_cast<char>(bytes.size()));
        asio::write(socket_, asio::buffer(bytes));
    }

private:
    asio::io_context context_;
    asio::ip::tcp::socket socket_{context_};
};

/// Reads so many sweeps and expects none to be missing.
void read_without_gap(Subscriber& reader, int sweeps) {
    auto last = reader.next_sweep().sequence;
    for (int i = 0; i < sweeps; ++i) {
        const auto sequence = reader.next_sweep().sequence;
        EXPECT_EQ(sequence, last + 1) << "the reader missed a sweep";
        last = sequence;
    }
}

TEST(SlowClient, ThatNeverReadsDelaysNobodyAndCostsBoundedMemory) {
    // Where AddressSanitizer is built in, it would keep what the gateway gives back.
    setenv("ASAN_OPTIONS", "quarantine_size_mb=1:thread_local_quarantine_size_kb=64", 1);
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Subscriber reader("tcp://" + gateway.tcp);
    reader.subscribe("", false);
    reader.next_sweep();

    constexpr std::size_t count = 100;
    std::vector<std::unique_ptr<NeverReads>> stalled;
    for (std::size_t i = 0; i < count; ++i) {
        stalled.push_back(std::make_unique<NeverReads>(gateway.tcp));
    }
    // A kernel takes some frames for each, eight more fill a mailbox.
    read_without_gap(reader, 40);
    const auto full = gateway.process.resident_bytes();
    read_without_gap(reader, 40);
    const auto later = gateway.process.resident_bytes();
    // Forty more sweeps of over 2 kB for each of a hundred clients would be over 8 MB.
    EXPECT_LT(later, full + 3'000'000);
}

}  // namespace
}  // namespace sweepcast::test
