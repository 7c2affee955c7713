// Faults: how users name them, and what they do to a scanner.
#include "driver/virtual/faults.hpp"

#include "driver/virtual/error.hpp"
#include "tests/driver/virtual/fake_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace sweepcast::virtual_lidar {
namespace {

using namespace std::chrono_literals;
using protocol::Command;
using protocol::HealthStatus;
using testing::HasSubstr;
using testing::IsEmpty;

Faults parsed(std::string_view text) {
    Faults faults;
    const auto added = add_fault(faults, text);
    EXPECT_TRUE(added) << text;
    return faults;
}

Bytes answer(FakeHost& host, Command command, Bytes payload = {}) {
    host.send(command, std::move(payload));
    host.run(50ms);
    return host.received();
}

TEST(AddFault, KnowsEachByItsName) {
    EXPECT_TRUE(parsed("mute").mute);
    EXPECT_TRUE(parsed("banner").banner);
    EXPECT_TRUE(parsed("motor-stall").motor_stall);
    EXPECT_TRUE(parsed("sample-time-zero").sample_time_zero);
    EXPECT_TRUE(parsed("bare-echo").bare_echo);
    EXPECT_TRUE(parsed("junk").junk);
    EXPECT_TRUE(parsed("leftovers").leftovers);
    EXPECT_EQ(parsed("noise=0.25").noise, 0.25);
    EXPECT_EQ(parsed("drop=1").drop, 1.0);
    EXPECT_EQ(parsed("burst").burst, 16ms);
    EXPECT_EQ(parsed("burst=1").burst, 1ms);
    EXPECT_EQ(parsed("protection-stop").health, (protocol::Health{HealthStatus::error, 1}));
    EXPECT_EQ(parsed("protection-stop=0x8001").health.code, 0x8001);
    EXPECT_EQ(parsed("warning=7").health, (protocol::Health{HealthStatus::warning, 7}));
    EXPECT_TRUE(parsed("deaf").deaf);
    EXPECT_TRUE(parsed("forced").forced);
    EXPECT_TRUE(parsed("garbage").garbage);
    EXPECT_TRUE(parsed("flood").flood);
    EXPECT_TRUE(parsed("half-answers").half_answers);
    EXPECT_EQ(parsed("duplicate=0.5").duplicate, 0.5);
    EXPECT_EQ(parsed("delay").delay, 200ms);
    EXPECT_EQ(parsed("delay=5000").delay, 5s);
    EXPECT_EQ(parsed("slow-spin-up").slow_spin_up, 10s);
    EXPECT_EQ(parsed("slow-spin-up=2.5").slow_spin_up, 2500ms);
    EXPECT_EQ(parsed("protection-stop-after=0.001").protection_stop_after, 1ms);
    EXPECT_EQ(parsed("wrong-baud").wrong_baud, 57'600U);
    EXPECT_EQ(parsed("wrong-baud=9600").wrong_baud, 9'600U);
    EXPECT_EQ(parsed("lying-length").lying_length, 0x3FFF'FFFFU);
    EXPECT_EQ(parsed("lying-length=0").lying_length, 0U);
}

TEST(ClearFault, TakesEachAwayThatCanBeAdded) {
    for (const auto* text :
         {"mute",
          "deaf",
          "banner",
          "forced",
          "motor-stall",
          "garbage",
          "flood",
          "half-answers",
          "sample-time-zero",
          "bare-echo",
          "junk",
          "leftovers",
          "noise=0.5",
          "drop=0.5",
          "duplicate=0.5",
          "burst=3",
          "delay=3",
          "slow-spin-up=2.5",
          "warning=0x7",
          "wrong-baud=9600",
          "protection-stop=0x8001",
          "lying-length=0",
          "protection-stop-after=1.5"}) {
        auto faults = parsed(text);
        EXPECT_EQ(faults_text(faults), text);
        const std::string name(text);
        ASSERT_TRUE(clear_fault(faults, name.substr(0, name.find('=')))) << text;
        EXPECT_EQ(faults, Faults{}) << text;
        EXPECT_EQ(faults_text(faults), "");
    }
}

TEST(ClearFault, LeavesTheOthersAndRefusesWhatIsNone) {
    Faults faults = parsed("noise=0.5");
    ASSERT_TRUE(add_fault(faults, "warning"));
    ASSERT_TRUE(clear_fault(faults, "protection-stop"));
    ASSERT_TRUE(clear_fault(faults, "mute"));
    EXPECT_EQ(faults_text(faults), "warning=0x1,noise=0.5");
    const auto refused = clear_fault(faults, "noise=0.5");
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, errc::invalid_option);
}

TEST(AddFault, AddsToThoseThatAreThere) {
    Faults faults;
    ASSERT_TRUE(add_fault(faults, "junk"));
    ASSERT_TRUE(add_fault(faults, "noise=0.1"));
    EXPECT_TRUE(faults.junk);
    EXPECT_EQ(faults.noise, 0.1);
}

class NoFault : public testing::TestWithParam<const char*> {};

TEST_P(NoFault, IsRefusedWithAHintAndChangesNothing) {
    Faults faults;
    const auto added = add_fault(faults, GetParam());
    ASSERT_FALSE(added);
    EXPECT_EQ(added.error().code, errc::invalid_option);
    EXPECT_THAT(added.error().cause, HasSubstr(GetParam()));
    EXPECT_FALSE(added.error().hint.empty());
    EXPECT_FALSE(faults.mute);
    EXPECT_EQ(faults.noise, 0.0);
    EXPECT_EQ(faults.health, protocol::Health{});
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    NoFault,
    testing::Values(
        "",
        "mut",
        "mute=1",
        "burst=",
        "burst=0",
        "burst=1001",
        "burst=2x",
        "noise",
        "noise=",
        "noise=1.5",
        "noise=-0.1",
        "noise=nan",
        "noise=0.1x",
        "drop=2",
        "warning=",
        "warning=65536",
        "warning=-1",
        "duplicate=2",
        "delay=0",
        "delay=5001",
        "slow-spin-up=0",
        "slow-spin-up=nan",
        "slow-spin-up=",
        "protection-stop-after",
        "protection-stop-after=86401",
        "wrong-baud=9599",
        "wrong-baud=-1",
        "lying-length=1073741824",
        "lying-length=0x1",
        "deaf=1",
        "protection-stop=0x",
        "protection-stop=12z"
    )
);

TEST(FaultsHelp, NamesEveryFaultThatCanBeAdded) {
    EXPECT_THAT(faults_help(), HasSubstr("protection-stop[=CODE]"));
    EXPECT_THAT(faults_help(), HasSubstr("noise=RATE"));
}

TEST(Mute, SaysNothingWhateverItIsAsked) {
    FakeHost host("a1m8", {.faults = parsed("mute")});
    host.spin_up();
    for (const auto command : {Command::get_info, Command::get_health, Command::scan}) {
        EXPECT_THAT(answer(host, command), IsEmpty());
    }
    host.send(Command::reset);
    host.run(1s);
    EXPECT_THAT(host.received(), IsEmpty());
}

TEST(Banner, IsPrintedAgainAndAgainAndNothingElse) {
    FakeHost host("a1m8", {.faults = parsed("banner")});
    host.send(Command::get_info);
    host.run(2s);
    const auto bytes = host.received();
    const std::string text(bytes.begin(), bytes.end());
    const std::string banner(host.persona.boot_text);
    EXPECT_EQ(text, banner + banner + banner + banner);
}

TEST(Banner, IsPrintedAlsoByAScannerThatHasNone) {
    FakeHost host("s2", {.faults = parsed("banner")});
    host.run(100ms);
    EXPECT_EQ(host.received().front(), 'R');
}

TEST(ProtectionStop, IsThereFromTheStartAndComesBackAfterAReset) {
    FakeHost host("a1m8", {.faults = parsed("protection-stop=0x1234")});
    const Bytes health{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 2, 0x34, 0x12};
    EXPECT_EQ(answer(host, Command::get_health), health);
    EXPECT_THAT(answer(host, Command::scan), IsEmpty());
    host.send(Command::reset);
    host.run(100ms);
    host.received();
    EXPECT_EQ(answer(host, Command::get_health), health);
    EXPECT_THAT(answer(host, Command::scan), IsEmpty());
}

TEST(Warning, IsReportedByAScannerThatWorks) {
    FakeHost host("a1m8", {.faults = parsed("warning=3")});
    EXPECT_EQ(answer(host, Command::get_health), (Bytes{0xA5, 0x5A, 3, 0, 0, 0, 0x06, 1, 3, 0}));
    host.spin_up();
    host.send(Command::scan);
    host.run(100ms);
    EXPECT_GT(host.measurements().size(), 800U);
}

TEST(MotorStall, TakesAScanRequestButBringsNoSamples) {
    for (const auto* key : {"a1m8", "a3m1", "s2", "c1"}) {
        FakeHost host(key, {.faults = parsed("motor-stall")});
        host.switch_on_and_spin_up();
        host.send(Command::scan);
        host.run(5s);
        EXPECT_EQ(host.received(), (Bytes{0xA5, 0x5A, 5, 0, 0, 0x40, 0x81})) << key;
    }
}

TEST(Noise, ChangesThatPartOfTheBytes) {
    FakeHost clean("a1m8");
    FakeHost noisy("a1m8", {.faults = parsed("noise=0.1"), .seed = 5});
    std::vector<Bytes> streams;
    for (auto* host : {&clean, &noisy}) {
        host->spin_up();
        host->send(Command::scan);
        host->run(2s);
        streams.push_back(host->received());
    }
    ASSERT_EQ(streams[0].size(), streams[1].size());
    std::size_t changed = 0;
    for (std::size_t i = 0; i < streams[0].size(); ++i) {
        changed += streams[0][i] != streams[1][i] ? 1U : 0U;
    }
    const auto all = static_cast<double>(streams[0].size());
    EXPECT_NEAR(static_cast<double>(changed) / all, 0.1, 0.01);
}

TEST(Drop, LosesThatPartOfTheBytes) {
    FakeHost host("a1m8", {.faults = parsed("drop=0.1"), .seed = 5});
    host.spin_up();
    host.send(Command::scan);
    host.run(2s);
    EXPECT_NEAR(static_cast<double>(host.received().size()), 2 * 2000 * 5 * 0.9, 150.0);
}

TEST(SampleTimeZero, IsWhatItSaysOfEveryMode) {
    FakeHost host("s3", {.faults = parsed("sample-time-zero")});
    EXPECT_EQ(
        answer(host, Command::get_lidar_conf, {0x71, 0, 0, 0, 1, 0}),
        (Bytes{0xA5, 0x5A, 8, 0, 0, 0, 0x20, 0x71, 0, 0, 0, 0, 0, 0, 0})
    );
    EXPECT_EQ(
        answer(host, Command::get_sample_rate),
        (Bytes{0xA5, 0x5A, 4, 0, 0, 0, 0x15, 0, 0, 0, 0})
    );
}

TEST(BareEcho, IsAllThatConfigurationQueriesGet) {
    FakeHost host("a1m8", {.faults = parsed("bare-echo")});
    for (const auto type : Bytes{0x01, 0x70, 0x7C}) {
        EXPECT_EQ(
            answer(host, Command::get_lidar_conf, {type, 0, 0, 0}),
            (Bytes{0xA5, 0x5A, 4, 0, 0, 0, 0x20, type, 0, 0, 0})
        );
    }
}

TEST(Junk, ComesBeforeEveryDescriptorAndDoublesItsStartByte) {
    FakeHost host("a1m8", {.faults = parsed("junk")});
    EXPECT_EQ(
        answer(host, Command::get_health),
        (Bytes{0x00, 0x37, 0xA5, 0x11, 0xFF, 0xA5, 0xA5, 0x5A, 3, 0, 0, 0, 0x06, 0, 0, 0})
    );
    const auto scan = answer(host, Command::scan);
    EXPECT_EQ(
        Bytes(scan.begin(), scan.begin() + 8),
        (Bytes{0, 0x37, 0xA5, 0x11, 0xFF, 0xA5, 0xA5, 0x5A})
    );
}

TEST(Burst, IsHowBytesReachTheHostNoneOfThemLost) {
    const auto deliveries = [](std::string_view fault) {
        FakeHost host("s2", fault.empty() ? EmulatorSettings{} : EmulatorSettings{parsed(fault)});
        host.switch_on_and_spin_up();
        host.send(protocol::encode(protocol::express_scan_request(1)));
        host.run(200ms);
        host.received();
        std::vector<std::size_t> sizes;
        for (int i = 0; i < 160; ++i) {
            host.run(1ms);
            sizes.push_back(host.received().size());
        }
        return sizes;
    };
    const auto steady = deliveries("");
    EXPECT_EQ(std::count(steady.begin(), steady.end(), 0U), 0);
    const auto bursts = deliveries("burst");
    EXPECT_EQ(std::count(bursts.begin(), bursts.end(), 0U), 150);
    const auto sum = [](const auto& sizes) {
        return std::accumulate(sizes.begin(), sizes.end(), std::size_t{});
    };
    EXPECT_NEAR(static_cast<double>(sum(bursts)), static_cast<double>(sum(steady)), 16 * 68);
    EXPECT_EQ(sum(deliveries("burst=1")), sum(steady));
}

TEST(Leftovers, AreMeasurementsThatNobodyAskedForUntilStop) {
    for (const auto* key : {"a1m8", "a3m1", "s2"}) {
        FakeHost host(key, {.faults = parsed("leftovers")});
        host.run(3s);
        EXPECT_GT(host.measurements().size(), 1000U) << key;
        host.send(Command::stop);
        host.run(100ms);
        host.received();
        EXPECT_EQ(answer(host, Command::get_health).size(), 10U) << key;
    }
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
