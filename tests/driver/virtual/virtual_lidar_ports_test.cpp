// VirtualLidar: on lines of every speed, and on networks.
#include "driver/link/termios2.hpp"
#include "driver/protocol/decode.hpp"
#include "driver/protocol/wire.hpp"
#include "driver/virtual/error.hpp"
#include "tests/driver/virtual/virtual_lidar_fixture.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/udp.hpp>
#include <gmock/gmock.h>

#include <algorithm>

namespace sweepcast::virtual_lidar {
namespace {

namespace asio = boost::asio;
namespace ip = asio::ip;
using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::StartsWith;

const std::vector<std::uint8_t> health_good{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 0, 0, 0};
const std::vector<std::uint8_t> info_descriptor{0xA5, 0x5A, 0x14, 0, 0, 0, 0x04};

class LinesTest : public VirtualLidarTest {
protected:
    asio::posix::stream_descriptor open_port_at(std::uint32_t baud) {
        auto port = open_port();
        EXPECT_TRUE(link::set_raw_8n1(port.native_handle(), baud));
        return port;
    }

    /// What comes within a moment.
    asio::awaitable<Bytes>
    read_for(asio::posix::stream_descriptor& port, std::chrono::milliseconds time) {
        asio::steady_timer timer(context_, time);
        co_await timer.async_wait(asio::use_awaitable);
        Bytes bytes(4096);
        const auto count = ::read(port.native_handle(), bytes.data(), bytes.size());
        bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
        co_return bytes;
    }
};

TEST_F(LinesTest, EveryModelIsUnderstoodAtItsOwnSpeed) {
    for (const auto& persona : personas()) {
        create({.model = std::string(persona.key)});
        context_.restart();
        run_with([&]() -> asio::awaitable<void> {
            auto port = open_port_at(persona.baud);
            co_await write(port, Command::get_info);
            auto answer = co_await read(port, 27);
            EXPECT_EQ(answer[7], persona.model) << persona.key;
            answer.resize(info_descriptor.size());
            EXPECT_EQ(answer, info_descriptor) << persona.key;
        });
        lidar_.reset();
    }
}

TEST_F(LinesTest, NoModelIsUnderstoodAtAnyOtherOfTheUsualSpeeds) {
    for (const auto* key : {"a1m8", "a3m1", "c1", "s2"}) {
        create({.model = key});
        context_.restart();
        run_with([&]() -> asio::awaitable<void> {
            for (const std::uint32_t baud : {115'200U, 256'000U, 460'800U, 1'000'000U}) {
                if (baud == find_persona(key)->baud) {
                    continue;
                }
                auto port = open_port_at(baud);
                for (const auto command : {Command::get_info, Command::get_health}) {
                    co_await write(port, command);
                    const auto answer = co_await read_for(port, 30ms);
                    const auto found = std::search(
                        answer.begin(),
                        answer.end(),
                        info_descriptor.begin(),
                        info_descriptor.begin() + 2
                    );
                    EXPECT_EQ(found, answer.end()) << key << " at " << baud;
                }
            }
        });
        lidar_.reset();
    }
}

TEST_F(LinesTest, AScanArrivesAsGarbageAtAnotherSpeed) {
    create({.model = "a1m8", .faults = {"leftovers"}});
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port_at(256'000);
        const auto bytes = co_await read(port, 1000);
        auto decoder = protocol::Decoder::create(protocol::AnswerType::express, {});
        protocol::Decoded decoded;
        decoder->push(bytes, {}, decoded);
        EXPECT_TRUE(decoded.samples.empty());
        log_.str("");
        port.close();
        co_await logged("closed by the host");
        auto right = open_port_at(115'200);
        co_await write(right, Command::stop);
        co_await logged("scan stopped");
        (void)co_await read_for(right, 50ms);
        co_await write(right, Command::get_health);
        EXPECT_EQ(co_await read(right, health_good.size()), health_good);
    });
}

TEST_F(LinesTest, AnySpeedIsUnderstoodWhenAskedFor) {
    create({.model = "s2", .any_baud = true});
    run_with([this]() -> asio::awaitable<void> {
        auto port = open_port_at(9'600);
        co_await write(port, Command::get_health);
        EXPECT_EQ(co_await read(port, health_good.size()), health_good);
    });
}

TEST_F(LinesTest, ASpeedIsNegotiatedAndSpokenUntilReset) {
    create({.model = "c1"});
    run_with([this]() -> asio::awaitable<void> {
        constexpr std::uint32_t wanted = 250'000;
        auto port = open_port_at(wanted);
        const Bytes magic(64, protocol::autobaud_byte);
        co_await asio::async_write(port, asio::buffer(magic), asio::use_awaitable);
        const auto measured = co_await read(port, 4);
        EXPECT_EQ(protocol::load_le32(std::span(measured).first<4>()), wanted);
        const auto confirm = protocol::encode(protocol::confirm_baud_request(wanted));
        co_await asio::async_write(port, asio::buffer(confirm), asio::use_awaitable);
        co_await write(port, Command::get_health);
        EXPECT_EQ(co_await read(port, health_good.size()), health_good);

        port.close();
        co_await logged("closed by the host");
        port = open_port_at(wanted);
        co_await write(port, Command::get_health);
        EXPECT_EQ(co_await read(port, health_good.size()), health_good) << "it is still spoken";

        co_await write(port, Command::reset);
        co_await logged("reset");
        EXPECT_TRUE(link::set_raw_8n1(port.native_handle(), find_persona("c1")->baud));
        (void)co_await read_for(port, find_persona("c1")->boot_time + 50ms);
        co_await write(port, Command::get_health);
        EXPECT_EQ(co_await read(port, health_good.size()), health_good);
    });
}

class NetworkTest : public VirtualLidarTest {
protected:
    template <class Protocol>
    typename Protocol::endpoint endpoint() const {
        const auto& url = lidar_->port();
        const auto port = static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1)));
        return {ip::address_v4::loopback(), port};
    }
};

TEST_F(NetworkTest, AHostIsAnsweredOverTcp) {
    create({.listen = "tcp://127.0.0.1:0"});
    EXPECT_THAT(lidar_->port(), StartsWith("tcp://127.0.0.1:"));
    run_with([this]() -> asio::awaitable<void> {
        ip::tcp::socket host(context_);
        co_await host.async_connect(endpoint<ip::tcp>(), asio::use_awaitable);
        co_await write(host, Command::get_health);
        EXPECT_EQ(co_await read(host, health_good.size()), health_good);
    });
}

TEST_F(NetworkTest, OneHostAfterTheOtherIsServedOverTcp) {
    create({.model = "s1", .listen = "127.0.0.1:0"});
    run_with([this]() -> asio::awaitable<void> {
        ip::tcp::socket first(context_);
        co_await first.async_connect(endpoint<ip::tcp>(), asio::use_awaitable);
        co_await write(first, Command::get_health);
        co_await read(first, health_good.size());
        ip::tcp::socket second(context_);
        co_await second.async_connect(endpoint<ip::tcp>(), asio::use_awaitable);
        co_await write(second, Command::get_health);
        first.close();
        EXPECT_EQ(co_await read(second, health_good.size()), health_good);
    });
}

TEST_F(NetworkTest, AT1IsAnsweredOverUdpAndSaysThatItHasAnAddress) {
    create({.model = "t1", .listen = "127.0.0.1:0"});
    EXPECT_THAT(lidar_->port(), StartsWith("udp://127.0.0.1:"));
    run_with([this]() -> asio::awaitable<void> {
        ip::udp::socket host(context_, ip::udp::v4());
        co_await host.async_connect(endpoint<ip::udp>(), asio::use_awaitable);
        const auto ask = protocol::encode({Command::get_lidar_conf, {0x79, 0x00, 0x00, 0x00}});
        co_await host.async_send(asio::buffer(ask), asio::use_awaitable);
        Bytes answer(100);
        answer.resize(co_await host.async_receive(asio::buffer(answer), asio::use_awaitable));
        EXPECT_EQ(answer.size(), 7U + 4U + 6U);
    });
}

TEST_F(NetworkTest, DatagramsHoldAtMost1024BytesAndGoToTheLastSender) {
    create({.model = "t1", .listen = "udp://127.0.0.1:0"});
    run_with([this]() -> asio::awaitable<void> {
        ip::udp::socket first(context_, ip::udp::v4());
        co_await first.async_connect(endpoint<ip::udp>(), asio::use_awaitable);
        const auto scan = protocol::encode({Command::force_scan, {}});
        co_await first.async_send(asio::buffer(scan), asio::use_awaitable);
        Bytes datagram(4096);
        std::size_t received = 0;
        while (received < 100'000) {
            const auto count =
                co_await first.async_receive(asio::buffer(datagram), asio::use_awaitable);
            EXPECT_LE(count, 1024U);
            received += count;
        }
        ip::udp::socket second(context_, ip::udp::v4());
        co_await second.async_connect(endpoint<ip::udp>(), asio::use_awaitable);
        const auto pwm = protocol::encode(protocol::set_motor_pwm_request(1));
        co_await second.async_send(asio::buffer(pwm), asio::use_awaitable);
        EXPECT_GT(co_await second.async_receive(asio::buffer(datagram), asio::use_awaitable), 0U);
    });
}

TEST_F(NetworkTest, AnAddressThatIsTakenIsNamed) {
    create({.listen = "tcp://127.0.0.1:0"});
    const auto second =
        VirtualLidar::create(context_.get_executor(), {.listen = lidar_->port()}, logger_);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, errc::port_unavailable);
    EXPECT_THAT(second.error().cause, HasSubstr(lidar_->port()));
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
