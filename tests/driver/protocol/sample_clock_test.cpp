// SampleClock: late arrivals in, steady times out. How true they are is for
// tests/driver/device/sample_times_test.
#include "driver/protocol/sample_clock.hpp"

#include <gtest/gtest.h>

namespace sweepcast::protocol {
namespace {

using namespace std::chrono_literals;
using std::chrono::microseconds;

/// Feeds a clock with dense capsules (40 samples, 1.25 ms) of a scanner that never stops.
class SampleClockTest : public testing::Test {
protected:
    explicit SampleClockTest(std::chrono::nanoseconds told = 31250ns)
        : clock({AnswerType::dense, told, 10us}) {}

    /// A packet that arrives so late. Returns the time of its first sample, less the true one.
    microseconds packet(microseconds late = 0us, std::vector<DecodeEvent> events = {}) {
        Decoded decoded;
        decoded.events = std::move(events);
        for (int k = 0; k < 40; ++k) {
            decoded.samples.push_back({.time = start + late + k * 31us + 40us});
        }
        clock.retime(decoded, 84, start + late + 2ms);
        for (const auto& sample : decoded.samples) {
            EXPECT_GT(sample.time, last) << "times go on";
            last = sample.time;
        }
        uncertainty = decoded.time_uncertainty;
        const auto off = decoded.samples.front().time - start - 40us;
        start += 1250us;
        return off;
    }

    void settle() {
        for (int i = 0; i < 1000; ++i) {
            packet();
        }
    }

    SampleClock clock;
    SampleTime start{1h};
    SampleTime last{};
    microseconds uncertainty{};
};

TEST_F(SampleClockTest, SaysThatItKnowsLittleAtFirst) {
    packet();
    EXPECT_GE(uncertainty, 20ms);
    settle();
    EXPECT_LE(uncertainty, 50us);
}

TEST_F(SampleClockTest, ALateArrivalMovesNothing) {
    settle();
    for (const auto late : {1ms, 16ms, 14ms, 3ms, 0ms}) {
        EXPECT_LE(std::chrono::abs(packet(late)), 30us);
    }
}

TEST_F(SampleClockTest, NoSamplesAreNoTrouble) {
    Decoded nothing;
    clock.retime(nothing, 10, start);
    EXPECT_EQ(nothing.time_uncertainty, 0us);
    nothing.events.push_back({0, DecodeEventKind::bytes_skipped, 100});
    clock.retime(nothing, 100, start);
    settle();
    EXPECT_LE(std::chrono::abs(packet()), 30us);
}

TEST_F(SampleClockTest, PacketsToldLostLeaveAGap) {
    settle();
    start += 2 * 1250us;
    EXPECT_LE(std::chrono::abs(packet(0us, {{0, DecodeEventKind::packets_lost, 2}})), 30us);
    EXPECT_GE(uncertainty, 1250us) << "it may not be as told";
    settle();
    EXPECT_LE(uncertainty, 50us);
}

TEST_F(SampleClockTest, PacketsLostWithoutAWordAreNoticed) {
    settle();
    start += 2 * 1250us;
    for (int i = 0; i < 250; ++i) {
        packet();
    }
    EXPECT_LE(std::chrono::abs(packet()), 100us);
}

TEST_F(SampleClockTest, PacketsToldLostThatWereNotAreNoticedAtOnce) {
    settle();
    packet(0us, {{0, DecodeEventKind::packets_lost, 1}});
    for (int i = 0; i < 100; ++i) {
        packet();
    }
    EXPECT_LE(std::chrono::abs(packet()), 100us);
}

TEST_F(SampleClockTest, APauseIsAGap) {
    settle();
    start += 3s;
    EXPECT_LE(packet(), uncertainty) << "it may just be late";
    EXPECT_GE(uncertainty, 3s);
    for (int i = 0; i < 50; ++i) {
        packet();
    }
    EXPECT_LE(std::chrono::abs(packet()), 100us);
}

TEST_F(SampleClockTest, AHostThatWasNotScheduledIsNoGap) {
    settle();
    for (int i = 80; i > 0; --i) {  // read one by one, all at the same time
        EXPECT_LE(std::chrono::abs(packet(i * 1250us)), 100us);
    }
    EXPECT_LE(std::chrono::abs(packet()), 100us);
}

TEST_F(SampleClockTest, AHostThatWasHeldUpForSecondsAndReadsWhatWaitedIsNoGap) {
    settle();
    constexpr int waited = 2400;  // three seconds, read within 12 ms
    for (int i = waited; i > 0; --i) {
        EXPECT_LE(std::chrono::abs(packet(i * 1245us)), 100us);
    }
    EXPECT_LE(std::chrono::abs(packet()), 100us);
}

TEST_F(SampleClockTest, WhatWasTakenForAPauseAndWasNoneIsMadeGoodSoon) {
    settle();
    for (int i = 0; i < 80; ++i) {  // a tenth of a second of nothing but late ones
        packet(3s);
    }
    EXPECT_GT(packet(3s), 2s) << "so it was a pause";
    for (int i = 0; i < 5000; ++i) {  // and now all is in time
        packet();
    }
    EXPECT_LE(std::chrono::abs(packet()), 100us);
}

TEST_F(SampleClockTest, WhatALineThatIsNearlyFullCatchesUpWithIsNoGap) {
    settle();
    for (int i = 150; i > 0; --i) {  // packets of 1.25 ms every 0.85 ms
        EXPECT_LE(std::chrono::abs(packet(i * 400us)), 100us) << i;
    }
    EXPECT_LE(std::chrono::abs(packet()), 100us);
}

class UntoldRateTest : public SampleClockTest {
protected:
    UntoldRateTest() : SampleClockTest(0ns) {}
};

TEST_F(UntoldRateTest, IsFound) {
    for (int i = 0; i < 1000; ++i) {
        Decoded decoded;
        decoded.samples.resize(40);
        for (auto& sample : decoded.samples) {
            sample.time = start + 40us;
        }
        clock.retime(decoded, 84, start + 2ms);
        EXPECT_GE(decoded.samples.front().time, last) << "times do not go back";
        last = decoded.samples.back().time;
        start += 1250us;
    }
    EXPECT_LE(std::chrono::abs(last - (start - 1250us + 40us)), 100us);
}

}  // namespace
}  // namespace sweepcast::protocol
