// One gateway's lidar published by another.
#include "server/client/sweep_joiner.hpp"
#include "server/frame/wire_message.hpp"
#include "tests/e2e/gateway.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace asio = boost::asio;
using asio::ip::tcp;
using testing::EndsWith;
using testing::HasSubstr;

namespace sweepcast::test {
namespace {

std::string remote(const std::string& tcp, const std::string& rest = "") {
    return "sweepcast://" + tcp + rest;
}

/// Its only lidar, as the gateway tells it.
std::string lidar_of(const GatewayProcess& gateway) {
    return http(gateway.http, "GET", "/api/v1/lidars").body;
}

std::string field(const std::string& json, const std::string& name) {
    const auto at = json.find("\"" + name + "\":");
    const auto begin = json.find('"', at + name.size() + 3) + 1;
    return json.substr(begin, json.find('"', begin) - begin);
}

using Sweeps = std::map<std::uint64_t, frame::DecodedScan>;

/// Takes sweeps in until `until` is among them.
void read_until(Subscriber& subscriber, std::uint64_t until, Sweeps& into) {
    while (into.empty() || into.rbegin()->first < until) {
        auto sweep = subscriber.next_sweep();
        into[sweep.sequence] = std::move(sweep.scan);
    }
}

/// A sweep as both gateways have it, but for the monotonic clock.
void expect_same(const frame::DecodedScan& there, const frame::DecodedScan& here) {
    ASSERT_EQ(there.sweep.samples.size(), here.sweep.samples.size());
    for (std::size_t i = 0; i < there.sweep.samples.size(); ++i) {
        const auto& a = there.sweep.samples[i];
        auto b = here.sweep.samples[i];
        EXPECT_EQ(there.unix_time(a), here.unix_time(b)) << i;
        b.time = a.time;
        ASSERT_EQ(a, b) << i;
    }
    EXPECT_EQ(there.sweep.period, here.sweep.period);
    EXPECT_EQ(there.sweep.losses, here.sweep.losses);
    EXPECT_EQ(there.mode, here.mode);
    EXPECT_EQ(there.answer_type, here.answer_type);
    EXPECT_EQ(there.sample_duration, here.sample_duration);
}

TEST(RemoteLidar, IsPublishedWithAllThatItsOwnGatewayTells) {
    GatewayProcess there({"--lidar", "virtual:a1m8"});
    GatewayProcess here({"--lidar", remote(there.tcp)});
    Subscriber near("tcp://" + there.tcp);
    Subscriber far("tcp://" + here.tcp);
    const auto state = far.wait_for_state(v1::Lidar::SCANNING);
    EXPECT_EQ(state.device().model(), "A1M8");
    EXPECT_THAT(state.url(), EndsWith(" via sweepcast://" + there.tcp));
    EXPECT_TRUE(state.is_virtual());
    near.subscribe();
    far.subscribe();
    Sweeps sweeps_there;
    Sweeps sweeps_here;
    const auto first = far.next_sweep().sequence;
    read_until(near, first + 4, sweeps_there);
    read_until(far, first + 4, sweeps_here);
    std::size_t compared = 0;
    for (const auto& [sequence, sweep] : sweeps_here) {
        if (sweeps_there.contains(sequence)) {
            expect_same(sweeps_there.at(sequence), sweep);
            ++compared;
        }
    }
    EXPECT_GE(compared, 2U);
    EXPECT_EQ(field(lidar_of(here), "id"), field(lidar_of(there), "id"));
    EXPECT_EQ(field(lidar_of(here), "serial_number"), field(lidar_of(there), "serial_number"));
}

TEST(RemoteLidar, IsPublishedInSectorsToo) {
    GatewayProcess there({"--lidar", "virtual:a1m8"});
    GatewayProcess here({"--lidar", remote(there.tcp)});
    Subscriber near("tcp://" + there.tcp);
    Subscriber far("tcp://" + here.tcp);
    far.wait_for_state(v1::Lidar::SCANNING);
    near.subscribe();
    v1::Subscribe wish;
    wish.set_kind(v1::SECTOR);
    wish.set_sector_deg(90);
    far.subscribe(wish);
    frame::FrameDecoder decoder;
    client::SweepJoiner joiner;
    Sweeps sweeps;
    // On a busy machine a gateway reads a whole revolution at once and cuts it into fewer sectors,
    // and either client misses frames. Such a revolution shows nothing: the next one counts.
    constexpr std::size_t most_sweeps = 300;
    bool compared = false;
    for (std::size_t seen = 0; !compared && seen < most_sweeps;) {
        const auto message = far.next([](const auto& received) { return received.has_frame(); });
        const auto& frame = message.frame();
        client::Scan scan;
        scan.kind = frame.kind();
        scan.sequence = frame.sequence();
        scan.sector = frame.sector();
        scan.last = frame.last();
        scan.scan = *decoder.decode(frame);
        if (joiner.take(std::move(scan)) && joiner.sweep().complete) {  // not amid the first turn
            ++seen;
            const auto& joined = joiner.sweep();
            read_until(near, joined.sequence, sweeps);
            if (frame.sector() + 1 >= 3 && sweeps.contains(joined.sequence)) {
                expect_same(sweeps.at(joined.sequence), joined.scan);
                compared = true;
            }
        }
    }
    EXPECT_TRUE(compared) << "no revolution came in three sectors to both";
}

TEST(RemoteLidar, IsControlledAtItsOwnGateway) {
    GatewayProcess there({"--lidar", "virtual:a1m8"});
    GatewayProcess here({"--lidar", remote(there.tcp, "?name=attic")});
    Subscriber("tcp://" + here.tcp).wait_for_state(v1::Lidar::SCANNING);
    for (const auto* command : {"start", "stop", "reset"}) {
        const auto answer = http(here.http, "POST", std::string("/api/v1/lidars/attic/") + command);
        EXPECT_EQ(answer.status, 409) << command;
        EXPECT_THAT(answer.body, HasSubstr("controlled_elsewhere"));
        EXPECT_THAT(answer.body, HasSubstr("http://127.0.0.1:8080/"));
    }
    EXPECT_EQ(http(here.http, "PATCH", "/api/v1/lidars/attic", R"({"speed_hz": 7})").status, 409);
    EXPECT_EQ(http(here.http, "GET", "/api/v1/lidars/attic/diagnosis").status, 409);
    EXPECT_EQ(http(here.http, "GET", "/api/v1/lidars/attic").status, 200);
}

TEST(RemoteLidar, ComesBackWithItsGateway) {
    const std::vector<std::string> lidar{"--lidar", "virtual:a1m8"};
    auto there = std::make_unique<GatewayProcess>(lidar);
    GatewayProcess here({"--lidar", remote(there->tcp)});
    const auto stream = there->tcp;
    Subscriber far("tcp://" + here.tcp);
    far.wait_for_state(v1::Lidar::SCANNING);
    there->process.signal(SIGTERM);
    there->process.wait();
    const auto lost = far.wait_for_state(v1::Lidar::BACKING_OFF);
    EXPECT_THAT(lost.cause(), HasSubstr("the gateway is shutting down"));
    EXPECT_EQ(lost.device().model(), "A1M8") << "what is known of it stays known";
    there = std::make_unique<GatewayProcess>(
        std::vector<std::string>{"--lidar", "virtual:a1m8", "--tcp", stream}
    );
    far.wait_for_state(v1::Lidar::SCANNING);
    far.subscribe();
    far.next_sweep();
}

TEST(RemoteLidar, MustBeNamedWhereThereAreSeveral) {
    GatewayProcess there({"--lidar", "virtual:a1m8?name=left", "--lidar", "virtual:a1m8?name=right"}
    );
    GatewayProcess here(
        {"--lidar",
         remote(there.tcp),
         "--lidar",
         remote(there.tcp, "/right"),
         "--lidar",
         remote(there.tcp, "/middle")}
    );
    std::map<std::uint32_t, v1::Lidar> lidars;
    Subscriber far("tcp://" + here.tcp);
    far.next([&](const v1::ServerMessage& message) {
        for (const auto& lidar : message.hello().lidars()) {
            lidars[lidar.number()] = lidar;
        }
        if (message.has_lidar()) {
            lidars[message.lidar().number()] = message.lidar();
        }
        return lidars[1].state() == v1::Lidar::BACKING_OFF &&
               lidars[2].state() == v1::Lidar::SCANNING &&
               lidars[3].state() == v1::Lidar::BACKING_OFF;
    });
    EXPECT_THAT(lidars[1].cause(), HasSubstr("has 2 lidars"));
    EXPECT_THAT(lidars[1].hint(), HasSubstr("left, right"));
    EXPECT_EQ(lidars[2].id(), "right");
    EXPECT_THAT(lidars[3].cause(), HasSubstr("no lidar \"middle\""));
}

void say(tcp::socket& socket, const v1::ServerMessage& message) {
    const frame::WireMessage wire(message);
    const auto bytes = wire.framed(frame::Framing::delimited);
    for (const auto part : {bytes.head, bytes.tail}) {
        asio::write(socket, asio::buffer(part.data(), part.size()));
    }
}

/// A gateway that the test plays: it takes the connection of the gateway under test.
class PlayedGateway {
public:
    [[nodiscard]] std::string address() const {
        return "127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port());
    }
    tcp::socket accept() { return acceptor_.accept(); }

private:
    asio::io_context context_;
    tcp::acceptor acceptor_{context_, {asio::ip::make_address("127.0.0.1"), 0}};
};

v1::ServerMessage greeting() {
    v1::ServerMessage message;
    message.mutable_hello()->set_protocol_version(1);
    return message;
}

v1::Lidar scanning(std::uint32_t number, const std::string& id, const std::string& serial) {
    v1::Lidar lidar;
    lidar.set_number(number);
    lidar.set_id(id);
    lidar.set_url("/dev/ttyUSB" + std::to_string(number) + "?mode=Boost");
    lidar.set_state(v1::Lidar::SCANNING);
    lidar.mutable_device()->set_serial_number(serial);
    return lidar;
}

TEST(RemoteLidar, IsFoundByTheNamesThatItsOwnGatewayFindsItBy) {
    const std::string first_serial = "A0A0A0A0000000000000000000000001";
    const std::string second_serial = "A0A0A0A0000000000000000000000002";
    PlayedGateway there;
    for (const auto& name : {std::string("A0A0A0A0"), second_serial, std::string("ttyUSB2")}) {
        GatewayProcess here({"--lidar", remote(there.address(), "/" + name)});
        auto peer = there.accept();
        auto hello = greeting();
        *hello.mutable_hello()->add_lidars() = scanning(1, first_serial, first_serial);
        *hello.mutable_hello()->add_lidars() = scanning(2, "A0A0A0A0", second_serial);
        say(peer, hello);
        Subscriber far("tcp://" + here.tcp);
        const auto state = far.wait_for_lidar([](const v1::Lidar& lidar) {
            return lidar.state() == v1::Lidar::SCANNING || !lidar.cause().empty();
        });
        EXPECT_EQ(state.device().serial_number(), second_serial) << name << ": " << state.cause();
    }
}

/// A stream's address that nobody has any more.
std::string free_address() {
    return GatewayProcess({"--lidar", "virtual:a1m8"}).tcp;
}

TEST(RemoteLidar, OfItsOwnGatewayIsRefused) {
    const auto own = free_address();
    Process gateway(
        {program(), "serve", "--lidar", remote(own), "--tcp", own, "--http", "127.0.0.1:0"}
    );
    EXPECT_EQ(gateway.wait(), 1);
    EXPECT_THAT(gateway.rest_of_log(), HasSubstr("this gateway's own stream"));
}

TEST(RemoteLidar, InALoopOfGatewaysFailsAndSaysSo) {
    const auto one = free_address();
    const auto other = free_address();
    GatewayProcess first({"--lidar", remote(other), "--tcp", one});
    GatewayProcess second({"--lidar", remote(one), "--tcp", other});
    Subscriber subscriber("tcp://" + one);
    subscriber.next([](const v1::ServerMessage& message) {
        return message.lidar().cause().find("a loop of them") != std::string::npos;
    });
    EXPECT_EQ(http(first.http, "GET", "/healthz").status, 200);
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++found;
    }
    return found;
}

v1::ServerMessage refusal_of(const std::string& cause) {
    v1::ServerMessage message;
    message.mutable_error()->set_code("refused");
    message.mutable_error()->set_message(cause);
    return message;
}

TEST(RemoteLidar, ThatIsRefusedSaysSoEachTimeAndUntilTheConnectionEnds) {
    PlayedGateway there;
    GatewayProcess here({"--lidar", remote(there.address())});
    auto peer = there.accept();
    Subscriber far("tcp://" + here.tcp);
    auto hello = greeting();
    const auto lidar = scanning(1, "A0A0A0A0", "A0A0A0A0000000000000000000000001");
    *hello.mutable_hello()->add_lidars() = lidar;
    say(peer, hello);
    far.wait_for_state(v1::Lidar::SCANNING);
    v1::ServerMessage state;
    *state.mutable_lidar() = lidar;
    for (const auto* cause : {"too many requests", "too many clients", "too many lidars"}) {
        say(peer, refusal_of(cause));
        say(peer, state);
        const auto told = far.wait_for_lidar([](const v1::Lidar&) { return true; });
        EXPECT_EQ(told.state(), v1::Lidar::BACKING_OFF);
        EXPECT_EQ(told.cause(), cause);
    }
}

TEST(RemoteLidar, OfAHostileGatewayNeitherControlsNorFloodsTheLog) {
    PlayedGateway there;
    GatewayProcess here({"--lidar", remote(there.address())});
    {
        auto hostile = there.accept();
        auto hello = greeting();
        hello.mutable_hello()->set_server("\x1b[2J\nforged line");
        say(hostile, hello);
        for (std::uint32_t i = 0; i < 1000; ++i) {
            v1::ServerMessage stats;
            stats.mutable_stats()->set_frames_dropped(i);
            say(hostile, stats);
            say(hostile, refusal_of("refusal " + std::to_string(i)));
        }
    }
    there.accept();  // it connects again: all of it has been read
    here.process.signal(SIGTERM);
    EXPECT_EQ(here.process.wait(), 0);
    const auto log = here.process.rest_of_log();
    EXPECT_THAT(log, HasSubstr("connected to \\u001b[2J\\nforged line\n"));
    constexpr std::size_t few = 100;  // one a second, however slow this machine is
    for (const auto* line : {"too slow for", "refusal "}) {
        EXPECT_GE(count(log, line), 1U) << line;
        EXPECT_LT(count(log, line), few) << line;
    }
}

}  // namespace
}  // namespace sweepcast::test
