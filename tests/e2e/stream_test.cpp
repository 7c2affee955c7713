// From a virtual lidar's bytes to clients' samples, through the real program.
#include "driver/protocol/decode.hpp"
#include "tests/e2e/gateway.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace sweepcast::test {
namespace {

using protocol::Sample;

/// A sample without its time, which is measured anew on each way.
std::tuple<std::uint16_t, std::uint32_t, int, int> value(const Sample& sample) {
    return {sample.angle.raw, sample.distance.raw, sample.quality, sample.flag};
}

std::vector<Sample> decode_file(const std::string& path, protocol::AnswerType type) {
    std::ifstream file(path, std::ios::binary);
    const std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
    auto decoder = protocol::Decoder::create(type, {std::chrono::microseconds(250), 115200, false});
    protocol::Decoded decoded;
    decoder->push(bytes, {}, decoded);
    return decoded.samples;
}

bool same_values(const Sample& a, const Sample& b) {
    return value(a) == value(b);
}

class ModeTest : public testing::TestWithParam<std::tuple<const char*, protocol::AnswerType>> {};

TEST_P(ModeTest, ClientsGetExactlyTheSamplesThatTheLidarSent) {
    const auto& [mode, answer_type] = GetParam();
    ScratchDirectory scratch;
    VirtualLidarProcess lidar({"--record", scratch.file("sent.bin")});
    GatewayProcess gateway({"--lidar", lidar.port, "--mode", mode});
    Subscriber tcp("tcp://" + gateway.tcp);
    tcp.subscribe();
    Subscriber websocket("ws://" + gateway.http + "/api/v1/stream?compression=none");

    std::vector<Sample> over_tcp;
    std::map<std::uint64_t, std::vector<Sample>> by_sequence;
    for (int i = 0; i < 8; ++i) {
        auto sweep = tcp.next_sweep();
        EXPECT_EQ(sweep.scan.answer_type, answer_type);
        EXPECT_EQ(sweep.scan.mode, mode);
        over_tcp.insert(
            over_tcp.end(),
            sweep.scan.sweep.samples.begin(),
            sweep.scan.sweep.samples.end()
        );
        by_sequence[sweep.sequence] = std::move(sweep.scan.sweep.samples);
    }
    int compared = 0;
    while (compared < 5) {
        const auto sweep = websocket.next_sweep();
        if (const auto same = by_sequence.find(sweep.sequence); same != by_sequence.end()) {
            EXPECT_EQ(same->second, sweep.scan.sweep.samples) << "sweep " << sweep.sequence;
            ++compared;
        }
    }

    // First: without its lidar it would wait for a port of that name, which others' may get.
    gateway.process.signal(SIGTERM);
    EXPECT_EQ(gateway.process.wait(), 0);
    lidar.process.signal(SIGTERM);
    EXPECT_EQ(lidar.process.wait(), 0);
    const auto sent = decode_file(scratch.file("sent.bin"), answer_type);
    const auto found =
        std::search(sent.begin(), sent.end(), over_tcp.begin(), over_tcp.end(), same_values);
    EXPECT_NE(found, sent.end()) << over_tcp.size() << " samples received are not among the "
                                 << sent.size() << " sent";
}

INSTANTIATE_TEST_SUITE_P(
    Modes,
    ModeTest,
    testing::Values(
        std::make_tuple("Standard", protocol::AnswerType::normal),
        std::make_tuple("Express", protocol::AnswerType::express)
    )
);

TEST(Stream, SamplesHaveTimesOfTheirOwnThatAddUpToTheTurn) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    const auto scan = client.next_sweep().scan;
    std::set<protocol::SampleTime> times;
    for (const auto& sample : scan.sweep.samples) {
        times.insert(sample.time);
    }
    // Two packets whose arrivals jitter may meet in a microsecond, no more.
    EXPECT_GT(times.size(), scan.sweep.samples.size() * 95 / 100);
    EXPECT_GT(scan.sweep.period, scan.sample_duration * (scan.sweep.samples.size() / 2));
    EXPECT_GT(scan.first_unix, std::chrono::seconds(1'700'000'000));
}

TEST(Stream, SequenceNumbersHaveNoGapForAClientThatReads) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8", "--threads", "2"});
    Subscriber client("ws://" + gateway.http + "/api/v1/stream?kind=sweep");
    auto last = client.next_sweep().sequence;
    for (int i = 0; i < 10; ++i) {
        const auto sequence = client.next_sweep().sequence;
        EXPECT_EQ(sequence, last + 1);
        last = sequence;
    }
}

TEST(Stream, HelloNamesTheLidarAndASubscribeToItIsHeard) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8", "--lidar", "virtual:a1m8"});
    Subscriber client("tcp://" + gateway.tcp);
    EXPECT_EQ(client.next().hello().protocol_version(), 1U);
    std::string second;
    client.next([&](const v1::ServerMessage& message) {
        second = message.lidar().number() == 2 && message.lidar().has_device()
                     ? message.lidar().id()
                     : "";
        return !second.empty();
    });
    client.subscribe(second);
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(client.next_sweep().lidar, second);
    }
}

TEST(Stream, ClientsOfBothKindsAndBothCompressionsAreServedAtOnce) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8", "--threads", "3"});
    std::vector<std::unique_ptr<Subscriber>> clients;
    for (int i = 0; i < 12; ++i) {
        const bool compressed = i % 2 == 0;
        if (i % 3 == 0) {
            clients.push_back(std::make_unique<Subscriber>("tcp://" + gateway.tcp));
            clients.back()->subscribe("", compressed);
        } else {
            const std::string query = compressed ? "compression=zstd" : "compression=none";
            clients.push_back(
                std::make_unique<Subscriber>("ws://" + gateway.http + "/api/v1/stream?" + query)
            );
        }
    }
    std::map<std::uint64_t, std::vector<Sample>> by_sequence;
    for (auto& client : clients) {
        for (int i = 0; i < 3; ++i) {
            auto sweep = client->next_sweep();
            const auto [same, is_new] =
                by_sequence.try_emplace(sweep.sequence, sweep.scan.sweep.samples);
            EXPECT_EQ(same->second, sweep.scan.sweep.samples);
        }
    }
}

TEST(Stream, AWrongWishIsRefusedAndTheConnectionLives) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe("nobody");
    const auto refusal = client.next([](const auto& message) { return message.has_error(); });
    EXPECT_EQ(refusal.error().code(), "lidar_not_found");
    client.subscribe();
    EXPECT_GT(client.next_sweep().scan.sweep.samples.size(), 100U);
}

class LongMessageTest : public testing::TestWithParam<std::string> {};

TEST_P(LongMessageTest, EndsItsConnection) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    const bool is_tcp = GetParam() == "tcp";
    Subscriber client(is_tcp ? "tcp://" + gateway.tcp : "ws://" + gateway.http + "/api/v1/stream");
    client.subscribe(std::string(5000, 'x'));  // a request has at most 4096 bytes
    try {
        client.next([](const auto& message) { return message.has_error(); });
        FAIL() << "the gateway has read the message";
    } catch (const std::runtime_error& failure) {
        EXPECT_THAT(failure.what(), testing::HasSubstr("the connection has ended"));
    }
}

INSTANTIATE_TEST_SUITE_P(
    Framings,
    LongMessageTest,
    testing::Values("tcp", "websocket"),
    [](const auto& framing) { return framing.param; }
);

TEST(Stream, BytesThatAreNoMessageEndTheirOwnConnectionOnly) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    HttpConnection garbage(gateway.tcp);
    EXPECT_THROW(garbage.send_raw("\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff"), std::exception);
    Subscriber other("tcp://" + gateway.tcp);  // nobody else notices
    other.subscribe();
    other.next_sweep();
}

}  // namespace
}  // namespace sweepcast::test
