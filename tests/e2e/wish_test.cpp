// What subscribers may wish for, through the real program.
#include "tests/e2e/gateway.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace sweepcast::test {
namespace {

using protocol::Sample;
using Samples = std::vector<Sample>;

constexpr auto is_frame = [](const v1::ServerMessage& message) { return message.has_frame(); };
constexpr auto is_answer = [](const v1::ServerMessage& message) {
    return message.has_subscribed();
};

Samples samples_of(const v1::Frame& frame) {
    frame::FrameDecoder decoder;
    return decoder.decode(frame).value().sweep.samples;
}

TEST(Wish, SectorsAddUpToTheSweepsThatOthersGet) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8", "--threads", "2"});
    const auto stream = "ws://" + gateway.http + "/api/v1/stream?kind=";
    for (const std::string wish : {"sector", "sector&max_latency_ms=5&compression=none"}) {
        Subscriber whole(stream + "sweep");
        Subscriber sliced(stream + wish);
        std::map<std::uint64_t, Samples> sweeps;
        Samples joined;
        std::uint32_t expected = 1;  // not before a sector 0
        int compared = 0;
        // On a busy machine a revolution may be read at once, which is one sector, or be missed by
        // either client. Such a revolution shows nothing.
        constexpr int most_revolutions = 300;
        for (int seen = 0; compared < 3 && seen < most_revolutions;) {
            const auto frame = sliced.next(is_frame).frame();
            ASSERT_EQ(frame.kind(), v1::SECTOR);
            if (frame.sector() == 0) {
                joined.clear();
                expected = 0;
            }
            if (frame.sector() != expected) {
                continue;
            }
            ++expected;
            const auto samples = samples_of(frame);
            joined.insert(joined.end(), samples.begin(), samples.end());
            if (!frame.last()) {
                continue;
            }
            ++seen;
            while (sweeps.empty() || sweeps.rbegin()->first < frame.sequence()) {
                auto sweep = whole.next_sweep();
                sweeps[sweep.sequence] = std::move(sweep.scan.sweep.samples);
            }
            const auto same = sweeps.find(frame.sequence());
            if (frame.sector() > 0 && same != sweeps.end()) {
                EXPECT_EQ(joined, same->second) << wish;
                ++compared;
            }
        }
        EXPECT_EQ(compared, 3) << wish;
    }
}

TEST(Wish, BinsAreAlwaysAtTheSameAngles) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Subscriber client("ws://" + gateway.http + "/api/v1/stream?bins=90&mask=100-200");
    std::set<std::vector<std::uint16_t>> angles;
    for (int i = 0; i < 3; ++i) {
        const auto samples = client.next_sweep().scan.sweep.samples;
        std::vector<std::uint16_t> these;
        int echoes = 0;
        for (const auto& sample : samples) {
            these.push_back(sample.angle.raw);
            echoes += sample.distance.has_echo() ? 1 : 0;
            if (sample.angle.degrees() > 100 && sample.angle.degrees() < 200) {
                EXPECT_FALSE(sample.distance.has_echo());
            }
        }
        EXPECT_EQ(these.size(), 90U);
        EXPECT_GT(echoes, 45);
        angles.insert(these);
    }
    EXPECT_EQ(angles.size(), 1U);
}

TEST(Wish, WhoComesLateGetsTheLatestSweepAtOnce) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8", "--threads", "3"});
    {
        Subscriber client("ws://" + gateway.http + "/api/v1/stream?kind=sweep");
        const auto id = client.wait_for_state(v1::Lidar::SCANNING).id();
        client.next_sweep();
        EXPECT_EQ(http(gateway.http, "POST", "/api/v1/lidars/" + id + "/stop").status, 200);
    }
    std::set<std::uint64_t> sequences;
    for (const std::string wish : {"kind=sweep", "kind=sweep", "every_nth=2", "bins=10"}) {
        Subscriber client("ws://" + gateway.http + "/api/v1/stream?" + wish);
        client.next(is_answer);
        sequences.insert(client.next_sweep().sequence);
    }
    EXPECT_EQ(sequences.size(), 1U);
}

TEST(Wish, CanBeChangedWhileFramesFlow) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Subscriber client("tcp://" + gateway.tcp);
    for (std::uint32_t request = 1; request <= 6; ++request) {
        v1::Subscribe wish;
        wish.set_request(request);
        wish.set_kind(request % 2 == 0 ? v1::SECTOR : v1::SWEEP);
        wish.set_compression(v1::NONE);
        client.subscribe(wish);
        const auto answer = client.next(is_answer).subscribed().wish();
        EXPECT_EQ(answer.request(), request);
        EXPECT_EQ(answer.sector_deg(), request % 2 == 0 ? 30 : 0);
        for (int i = 0; i < 3; ++i) {
            EXPECT_EQ(client.next(is_frame).frame().kind(), wish.kind());
        }
    }
}

TEST(Wish, ARateLimitTellsWhatItLeavesOut) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    Subscriber client("ws://" + gateway.http + "/api/v1/stream?max_rate_hz=3");
    std::uint64_t before = client.next_sweep().sequence;
    for (int i = 0; i < 5; ++i) {
        const auto frame = client.next(is_frame).frame();
        EXPECT_EQ(frame.sequence() - before - 1, frame.omitted());
        before = frame.sequence();
    }
    EXPECT_GT(before, 5U);
}

TEST(Wish, WhatContradictsItselfIsRefusedAndTheWishBeforeGoesOn) {
    GatewayProcess gateway({"--lidar", "virtual:a1m8"});
    const auto refused = http(gateway.http, "GET", "/api/v1/stream?kind=sector&bins=10");
    EXPECT_NE(refused.status, 200);
    EXPECT_THROW(
        Subscriber("ws://" + gateway.http + "/api/v1/stream?kind=sector&bins=10"),
        std::runtime_error
    );
    Subscriber client("tcp://" + gateway.tcp);
    client.subscribe();
    v1::Subscribe wish;
    wish.set_request(4);
    wish.set_sector_deg(30);
    client.subscribe(wish);
    const auto error = client.next([](const auto& message) { return message.has_error(); }).error();
    EXPECT_EQ(error.code(), "contradiction");
    EXPECT_EQ(error.request(), 4U);
    EXPECT_GT(client.next_sweep().scan.sweep.samples.size(), 100U);
}

}  // namespace
}  // namespace sweepcast::test
