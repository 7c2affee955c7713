// Device: each test drives one lidar's life on an io_context of its own and waits for events, never
// for a while.
#include "driver/device/device.hpp"

#include "driver/device/error.hpp"
#include "driver/link/error.hpp"
#include "driver/protocol/encode_normal.hpp"
#include "tests/driver/device/fake_scanner.hpp"
#include "tests/driver/device/memory_link.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/system/system_error.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace sweepcast::device {
namespace {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using protocol::Command;
using testing::Contains;
using testing::HasSubstr;

constexpr auto patience = 60s;
constexpr RecoveryPolicy at_once{.attempts = {1ms, 1ms}, .resets = 0};
constexpr RecoveryPolicy resets_at_once{
    .attempts = {1ms, 1ms},
    .resets = 2,
    .reset_waits = {1ms, 1ms}};
constexpr RecoveryPolicy not_again{.attempts = {1h, 1h}, .resets = 0, .restarts = 0};

Diagnosis a_diagnosis() {
    Diagnosis diagnosis;
    diagnosis.port = "here";
    return diagnosis;
}

class DeviceTest : public testing::Test, public DeviceObserver {
public:  // the tests' coroutines are lambdas, which inherit no access
    void on_state(const DeviceState& state) override {
        phases.push_back(state.phase);
        told_code = state.health ? state.health->code : 0;
        changed.notify();
    }
    void on_sweep(CapturedSweep sweep) override {
        if (sweep_throws) {
            throw std::length_error("no room for a sweep");
        }
        expect_to_complete_progress(sweep);
        sweeps.push_back(std::move(sweep));
        changed.notify();
    }
    void on_progress(const SweepProgress& told) override {
        const auto& samples = told.sweep.samples;
        EXPECT_FALSE(samples.empty());
        EXPECT_EQ(told.sequence, sweeps.empty() ? 1 : sweeps.back().sequence + 1);
        EXPECT_EQ(told.mode, device->state().mode);
        if (told.sweep.begun == under_way.sweep.begun) {
            EXPECT_GE(samples.size(), gathered.size());
            EXPECT_EQ(told.monotonic_to_unix, under_way.monotonic_to_unix);
        } else if (told.sequence == under_way.sequence) {
            ++given_up;
        }
        gathered.assign(samples.begin(), samples.end());
        under_way = told;
        under_way.sweep.samples = {};
        changed.notify();
    }

    /// A sweep goes on from what was told of it while it was under way.
    void expect_to_complete_progress(const CapturedSweep& sweep) const {
        if (sweep.sweep.begun != under_way.sweep.begun) {
            return;
        }
        EXPECT_EQ(sweep.sequence, under_way.sequence);
        EXPECT_EQ(sweep.monotonic_to_unix, under_way.monotonic_to_unix);
        EXPECT_EQ(sweep.sample_duration, under_way.sample_duration);
        EXPECT_EQ(sweep.answer_type, under_way.answer_type);
        const auto& samples = sweep.sweep.samples;
        ASSERT_GE(samples.size(), gathered.size());
        EXPECT_TRUE(std::equal(gathered.begin(), gathered.end(), samples.begin()));
    }

    Device& make_device(
        DeviceOptions options = {.recovery = at_once},
        std::function<asio::awaitable<void>(std::chrono::steady_clock::time_point)> wait = {},
        std::function<bool(const protocol::DeviceInfo&)> is_it = {}
    ) {
        options.health_interval = 10ms;
        options.look_interval = 1ms;
        auto open = [this](std::uint32_t baud
                    ) -> asio::awaitable<Result<std::unique_ptr<link::Link>, Problem>> {
            ++opened;
            opened_at = baud;
            line.baud = line.baud != 0 ? baud : 0;
            if (open_throws) {
                std::rethrow_exception(open_throws);
            }
            if (open_problem) {
                co_return *open_problem;
            }
            co_return std::unique_ptr<link::Link>(std::make_unique<MemoryLink>(line));
        };
        device = std::make_unique<Device>(
            context.get_executor(),
            Port{open, std::move(wait), std::move(is_it)},
            options,
            *this,
            log
        );
        return *device;
    }

    /// Runs the device's life beside `script`, and ends it when the script has.
    void play(asio::awaitable<void> script) {
        spawn(device->run());
        spawn([](DeviceTest& test, asio::awaitable<void> body) -> asio::awaitable<void> {
            co_await std::move(body);
            test.device->shut_down();
        }(*this, std::move(script)));
        context.run_for(patience);
        ASSERT_TRUE(context.stopped()) << "the device's life did not end";
    }

    /// Waits until `reached` holds; fails the test if it does not come to that.
    template <class Condition>
    asio::awaitable<void> until(Condition reached) {
        const auto deadline = std::chrono::steady_clock::now() + patience / 2;
        while (!reached()) {
            const bool woken = co_await changed.wait_until(deadline);
            if (!woken) {
                ADD_FAILURE() << "it did not come to that; the phase is "
                              << name(device->state().phase);
                co_return;
            }
        }
    }

    asio::awaitable<void> until_phase(Phase phase) {
        return until([this, phase] { return device->state().phase == phase; });
    }

    void spawn(asio::awaitable<void> task) {
        asio::co_spawn(context, std::move(task), [](std::exception_ptr failure) {
            if (failure) {
                std::rethrow_exception(failure);
            }
        });
    }

    asio::io_context context;
    Line line{context.get_executor()};
    FakeScanner scanner{line};
    async::Notifier changed{context.get_executor()};
    std::shared_ptr<spdlog::logger> log = std::make_shared<spdlog::logger>("test");
    std::unique_ptr<Device> device;
    std::vector<Phase> phases;
    std::uint16_t told_code{};
    std::vector<CapturedSweep> sweeps;
    SweepProgress under_way;  ///< as told last; its samples are `gathered`
    std::vector<protocol::Sample> gathered;
    int given_up{};
    std::optional<Problem> open_problem;
    std::exception_ptr open_throws;
    int opened{};
    std::uint32_t opened_at{};
    bool sweep_throws{};
};

TEST_F(DeviceTest, IdentifiesThenScansThenDeliversSweeps) {
    make_device();
    play(until([this] { return sweeps.size() >= 2; }));

    ASSERT_GE(phases.size(), 4U);
    EXPECT_EQ(phases[0], Phase::opening);
    EXPECT_EQ(phases[1], Phase::identifying);
    EXPECT_EQ(phases[2], Phase::starting);
    EXPECT_EQ(phases[3], Phase::scanning);
    ASSERT_GE(sweeps.size(), 2U);
    EXPECT_EQ(sweeps[0].sweep.samples.size(), 360U);
    EXPECT_EQ(sweeps[0].sequence, 1U);
    EXPECT_EQ(sweeps[1].sequence, 2U);
    EXPECT_EQ(sweeps[0].mode, "Express");
}

TEST_F(DeviceTest, TellsOfASweepUnderWayWhatItHasSoFar) {
    scanner.turns_at_start = 1;
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until([&test] { return test.gathered.size() == 360; });
        EXPECT_EQ(test.under_way.sequence, 1U);
        EXPECT_TRUE(test.sweeps.empty());
        for (unsigned degree = 0; degree < 100; ++degree) {
            test.scanner.send_sample(degree);
        }
        co_await test.until([&test] { return test.gathered.size() == 100; });
        EXPECT_EQ(test.under_way.sequence, 2U);
        EXPECT_EQ(test.sweeps.size(), 1U);
        test.scanner.send_sample(100);
        co_await test.until([&test] { return test.gathered.size() == 101; });
        EXPECT_EQ(test.under_way.sequence, 2U);
    }(*this));
    EXPECT_EQ(given_up, 0);
}

TEST_F(DeviceTest, ASweepUnderWayWhenTheScanEndsIsGivenUpAndItsNumberUsedAgain) {
    scanner.turns_at_start = 1;
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until([&test] { return test.gathered.size() == 360; });
        EXPECT_TRUE(co_await test.device->stop());
        EXPECT_TRUE(co_await test.device->start(""));
        co_await test.until([&test] { return test.given_up == 1; });
    }(*this));
    EXPECT_EQ(under_way.sequence, 1U);
}

TEST_F(DeviceTest, TellsWhoTheLidarIs) {
    make_device();
    play(until_phase(Phase::scanning));

    ASSERT_TRUE(device->state().info);
    EXPECT_EQ(*device->state().info, scanner.info);
    ASSERT_EQ(device->state().modes.size(), 2U);
    EXPECT_EQ(device->state().modes[0].name, "Standard");
    EXPECT_EQ(device->state().modes[1].name, "Express");
}

TEST_F(DeviceTest, EndsWithTheScanStoppedAndTheMotorOff) {
    make_device();
    play(until_phase(Phase::scanning));

    EXPECT_EQ(scanner.count(Command::stop), 3U);  // looking for it, identifying it, the end
    EXPECT_EQ(scanner.requests.back(), protocol::set_motor_pwm_request(0));
    EXPECT_EQ(line.dtr, true);  // asserted: an A1's motor is off
    EXPECT_EQ(phases.back(), Phase::disconnected);
}

TEST_F(DeviceTest, ReleasesDtrSoThatTheMotorTurnsWhileScanning) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_EQ(test.line.dtr, false);
    }(*this));
}

TEST_F(DeviceTest, SwitchesTheMotorByRequestWhereTheLineHasNoDtr) {
    line.has_dtr = false;
    make_device();
    play(until_phase(Phase::scanning));

    EXPECT_THAT(scanner.requests, Contains(protocol::set_motor_pwm_request(660)));
    EXPECT_EQ(scanner.requests.back(), protocol::set_motor_pwm_request(0));
}

TEST_F(DeviceTest, StaysIdleWhenNotToldToScan) {
    make_device({.scan_at_once = false, .recovery = at_once});
    play(until_phase(Phase::idle));

    EXPECT_EQ(scanner.count(Command::express_scan), 0U);
    EXPECT_EQ(line.dtr, true);
}

TEST_F(DeviceTest, StopAndStartFollowEachOther) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        const auto stopped = co_await test.device->stop();
        EXPECT_TRUE(stopped);
        EXPECT_EQ(test.device->state().phase, Phase::idle);
        EXPECT_EQ(test.line.dtr, true);
        const auto started = co_await test.device->start("");
        EXPECT_TRUE(started);
        EXPECT_EQ(test.device->state().phase, Phase::scanning);
        EXPECT_EQ(test.line.dtr, false);
    }(*this));
    EXPECT_EQ(scanner.count(Command::express_scan), 2U);
}

TEST_F(DeviceTest, SaysWhyItRestsThoughNobodyWatchesAnyway) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        test.device->set_demand(false);
        co_await test.until_phase(Phase::idle);
        EXPECT_THAT(test.device->state().cause, HasSubstr("nobody watches"));
        EXPECT_TRUE(co_await test.device->stop());
        EXPECT_EQ(test.device->state().cause, "") << "its user stopped it";
        EXPECT_TRUE(co_await test.device->start(""));
        EXPECT_THAT(test.device->state().cause, HasSubstr("nobody watches"));
        test.device->set_demand(true);
        co_await test.until_phase(Phase::scanning);
        EXPECT_EQ(test.device->state().cause, "");
    }(*this));
}

TEST_F(DeviceTest, ChangesTheModeOfARunningScan) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        const auto started = co_await test.device->start("standard");
        EXPECT_TRUE(started);
        EXPECT_EQ(test.device->state().mode, "Standard");
    }(*this));
    EXPECT_EQ(scanner.count(Command::scan), 1U);
}

TEST_F(DeviceTest, RefusesAnUnknownModeAndNamesTheKnownOnes) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        const auto started = co_await test.device->start("Turbo");
        EXPECT_FALSE(started);
        EXPECT_EQ(started.error().code, errc::unknown_mode);
        EXPECT_THAT(started.error().hint, HasSubstr("Standard, Express"));
        EXPECT_EQ(test.device->state().phase, Phase::scanning);
    }(*this));
}

TEST_F(DeviceTest, SaysWhyAPortDoesNotOpenAndTriesAgain) {
    open_problem = Problem{make_error_code(errc::no_answer), "no such port", "plug it in"};
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        EXPECT_EQ(test.device->state().cause, "no such port");
        EXPECT_EQ(test.device->state().hint, "plug it in");
        test.open_problem.reset();
        co_await test.until_phase(Phase::scanning);
        EXPECT_EQ(test.device->state().cause, "");
    }(*this));
    EXPECT_GE(opened, 2);
}

TEST_F(DeviceTest, FailsWithAdviceWhenNothingAnswers) {
    scanner.answers = false;
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        EXPECT_THAT(test.device->state().cause, HasSubstr("does not answer"));
        EXPECT_THAT(test.device->state().hint, HasSubstr("power"));
    }(*this));
}

TEST_F(DeviceTest, StartTellsWhyAFailedLidarCannotBeStarted) {
    open_problem = Problem{make_error_code(errc::no_answer), "no such port", "plug it in"};
    make_device({.scan_at_once = false, .recovery = at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        const auto started = co_await test.device->start("");
        EXPECT_FALSE(started);
        EXPECT_EQ(started.error().cause, "no such port");
    }(*this));
}

TEST_F(DeviceTest, AStartOfALidarThatIsAwayIsKept) {
    open_problem = Problem{make_error_code(errc::no_answer), "no such port", "plug it in"};
    make_device({.scan_at_once = false, .recovery = at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        const auto started = co_await test.device->start("");
        EXPECT_EQ(started.error().code, errc::pending);
        test.open_problem.reset();
        co_await test.until_phase(Phase::scanning);
    }(*this));
}

TEST_F(DeviceTest, AResetOfALidarThatIsAwayIsNotKept) {
    open_problem = Problem{make_error_code(errc::no_answer), "no such port", "plug it in"};
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        const auto reset = co_await test.device->reset();
        EXPECT_EQ(reset.error().code, errc::not_ready);
        EXPECT_EQ(reset.error().cause, "no such port");
        test.open_problem.reset();
        co_await test.until_phase(Phase::scanning);
        EXPECT_EQ(test.scanner.count(Command::reset), 0U);
    }(*this));
}

TEST_F(DeviceTest, ComesBackAfterTheCableWasPulled) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until([&test] { return test.sweeps.size() >= 2; });
        const auto last = test.sweeps.back().sequence;
        test.line.unplug();
        co_await test.until_phase(Phase::backing_off);
        EXPECT_THAT(test.device->state().hint, HasSubstr("cable"));
        co_await test.until([&test, last] { return test.sweeps.back().sequence > last; });
    }(*this));
    EXPECT_EQ(opened, 2);
}

TEST_F(DeviceTest, ASecondStopChangesNothing) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_TRUE(co_await test.device->stop());
        const auto sent = test.scanner.requests.size();
        EXPECT_TRUE(co_await test.device->stop());
        EXPECT_EQ(test.scanner.requests.size(), sent);
    }(*this));
}

TEST_F(DeviceTest, ReportsAProtectionStopAndLeavesItByReset) {
    scanner.health = {protocol::HealthStatus::error, 0x8001};
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::failed);
        EXPECT_THAT(test.device->state().hint, HasSubstr("reset"));
        EXPECT_EQ(test.scanner.count(Command::express_scan), 0U);
        const auto reset = co_await test.device->reset();
        EXPECT_TRUE(reset);
        EXPECT_EQ(test.device->state().phase, Phase::scanning);
    }(*this));
    EXPECT_EQ(scanner.count(Command::reset), 1U);
}

TEST_F(DeviceTest, ResetSaysSoWhenTheFaultStays) {
    scanner.health = {protocol::HealthStatus::error, 0x8001};
    scanner.reset_heals = false;
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::failed);
        const auto reset = co_await test.device->reset();
        EXPECT_FALSE(reset);
        EXPECT_EQ(reset.error().code, errc::not_ready);
        EXPECT_THAT(reset.error().cause, HasSubstr("protection stop"));
    }(*this));
}

TEST_F(DeviceTest, ResetOfAnIdleLidarLeavesItIdle) {
    make_device({.scan_at_once = false, .recovery = at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::idle);
        EXPECT_TRUE(co_await test.device->reset());
        EXPECT_EQ(test.device->state().phase, Phase::idle);
    }(*this));
    EXPECT_EQ(scanner.count(Command::reset), 1U);
}

TEST_F(DeviceTest, AStopDuringStartingWins) {
    scanner.turns_at_start = 0;  // the motor never gets up to speed
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::starting);
        EXPECT_TRUE(co_await test.device->stop());
        EXPECT_EQ(test.device->state().phase, Phase::idle);
    }(*this));
}

TEST_F(DeviceTest, SilenceInMidScanIsAFailureWithACauseAndTheMotorOff) {
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);  // the fake sends three turns and falls silent
        co_await test.until_phase(Phase::backing_off);
        EXPECT_THAT(test.device->state().cause, HasSubstr("no samples"));
        EXPECT_THAT(test.device->state().hint, HasSubstr("motor"));
        EXPECT_EQ(test.line.dtr, true);
        EXPECT_EQ(test.scanner.requests.back(), protocol::set_motor_pwm_request(0));
    }(*this));
}

TEST_F(DeviceTest, SamplesOfALidarThatDoesNotTurnAreAFailureWithACauseAndTheMotorOff) {
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        test.spawn([](DeviceTest& itself) -> asio::awaitable<void> {
            while (itself.device->state().phase == Phase::scanning) {
                itself.scanner.send_sample(90);
                async::Notifier never(itself.context.get_executor());
                co_await never.wait_until(std::chrono::steady_clock::now() + 1ms);
            }
        }(test));
        co_await test.until_phase(Phase::backing_off);
        EXPECT_THAT(test.device->state().cause, HasSubstr("no complete turn"));
        EXPECT_THAT(test.device->state().hint, HasSubstr("motor"));
        EXPECT_EQ(test.line.dtr, true);
    }(*this));
}

TEST_F(DeviceTest, AModeAskedForBeforeTheModesAreKnownIsRefusedOnceTheyAre) {
    make_device({.scan_at_once = false, .recovery = at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        const auto started = co_await test.device->start("Turbo");
        EXPECT_FALSE(started);
        EXPECT_EQ(started.error().code, errc::unknown_mode);
    }(*this));
}

TEST_F(DeviceTest, AnIdleLidarThatFallsSilentIsNoticed) {
    make_device({.scan_at_once = false, .recovery = at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::idle);
        test.scanner.answers = false;
        co_await test.until_phase(Phase::backing_off);
    }(*this));
}

TEST_F(DeviceTest, AnIdleLidarThatBabblesIsAskedAllTheSame) {
    make_device({.scan_at_once = false, .recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::idle);
        test.scanner.answers = false;
        test.line.babbles = true;
        test.line.changed.notify();
        co_await test.until_phase(Phase::backing_off);
    }(*this));
}

TEST_F(DeviceTest, TellsWhenTheCodeOfAProtectionStopChanges) {
    scanner.health = {protocol::HealthStatus::error, 0x8001};
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::failed);
        test.scanner.health.code = 0x8002;
        co_await test.until([&test] { return test.told_code == 0x8002; });
    }(*this));
}

TEST_F(DeviceTest, AProtectionStopThatEndsByItselfIsNoticed) {
    scanner.health = {protocol::HealthStatus::error, 0x8001};
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::failed);
        test.scanner.health = {};
        co_await test.until_phase(Phase::scanning);
    }(*this));
    EXPECT_EQ(scanner.count(Command::reset), 0U);
}

TEST_F(DeviceTest, AProtectionStopIsLeftByItself) {
    scanner.health = {protocol::HealthStatus::error, 0x8001};
    make_device({.recovery = resets_at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_EQ(test.device->state().recoveries, 1U);
    }(*this));
    EXPECT_THAT(phases, Contains(Phase::protection_stop));
    EXPECT_THAT(phases, Contains(Phase::resetting));
    EXPECT_EQ(scanner.count(Command::reset), 1U);
    EXPECT_EQ(opened, 1);
}

TEST_F(DeviceTest, AProtectionStopThatResetsDoNotHelpIsLeftToTheUser) {
    scanner.health = {protocol::HealthStatus::error, 0x8001};
    scanner.reset_heals = false;
    make_device({.recovery = resets_at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::failed);
        EXPECT_THAT(test.device->state().cause, HasSubstr("2 resets have not helped"));
        EXPECT_THAT(test.device->state().hint, HasSubstr("unplug it"));
        EXPECT_EQ(test.scanner.count(Command::reset), 2U);
        test.scanner.reset_heals = true;
        const auto reset = co_await test.device->reset();
        EXPECT_TRUE(reset) << "the user may try again";
    }(*this));
    EXPECT_EQ(opened, 1);
}

TEST_F(DeviceTest, AProtectionStopOfALidarThatIsNotToScanIsLeftAlone) {
    scanner.health = {protocol::HealthStatus::error, 0x8001};
    make_device({.scan_at_once = false, .recovery = resets_at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::protection_stop);
        EXPECT_THAT(test.device->state().cause, HasSubstr("error code 32769 (0x8001)"));
        EXPECT_THAT(test.device->state().hint, HasSubstr("reset"));
        test.scanner.health.code = 0x8002;
        co_await test.until([&test] { return test.told_code == 0x8002; });  // it is asked on
    }(*this));
    EXPECT_EQ(scanner.count(Command::reset), 0U);
}

TEST_F(DeviceTest, AStalledScanIsBegunAgainOnTheSameConnection) {
    make_device({.recovery = resets_at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until([&test] { return test.sweeps.size() >= 2; });
        const auto last = test.sweeps.back();  // the fake sends three turns and falls silent
        co_await test.until_phase(Phase::stalled);
        EXPECT_THAT(test.device->state().cause, HasSubstr("no samples"));
        const auto before = test.sweeps.size();
        co_await test.until([&test, before] { return test.sweeps.size() > before; });
        EXPECT_EQ(test.sweeps[before].sequence, test.sweeps[before - 1].sequence + 1);
        EXPECT_GT(test.sweeps[before].gap, 0ns);
        EXPECT_EQ(last.gap, 0ns);
        EXPECT_GE(test.device->state().recoveries, 1U);
    }(*this));
    EXPECT_EQ(opened, 1);
}

TEST_F(DeviceTest, AHiccupOfTheLineIsToldAndCostsNothing) {
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        co_await test.until_phase(Phase::stalled);  // the fake sends three turns and falls silent
        for (unsigned degree = 0; degree < 10; ++degree) {
            test.scanner.send_sample(degree);
        }
        co_await test.until_phase(Phase::scanning);
    }(*this));
    EXPECT_EQ(scanner.count(Command::express_scan), 1U);
}

TEST_F(DeviceTest, AGatewayThatIsHeldUpTakesItForNoFaultOfTheLidar) {
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        const auto complete = test.sweeps.size();
        for (unsigned degree = 0; degree < 10; ++degree) {
            test.scanner.send_sample(degree);
        }
        co_await test.until([&test, complete] { return test.sweeps.size() > complete; });
        const auto before = test.device->state().line.samples;
        // The thread is held up, longer than a silence or a turn may last.
        const auto goes_on_at = std::chrono::steady_clock::now() + 3500ms;
        while (std::chrono::steady_clock::now() < goes_on_at) {
        }
        for (unsigned degree = 10; degree < 20; ++degree) {  // what came meanwhile
            test.scanner.send_sample(degree);
        }
        co_await test.until([&test, before] { return test.device->state().line.samples > before; });
    }(*this));
    EXPECT_THAT(phases, testing::Not(Contains(Phase::stalled)));
}

TEST_F(DeviceTest, AGatewayThatIsHeldUpInMidPacketTakesItForNoFaultOfTheLidar) {
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        const auto before = test.device->state().line.samples;
        // The thread is held up, longer than a silence may last.
        const auto goes_on_at = std::chrono::steady_clock::now() + 500ms;
        while (std::chrono::steady_clock::now() < goes_on_at) {
        }
        const auto packet = protocol::encode_normal({});
        test.line.send(std::span(packet).first<2>());
        while (!test.line.to_host.empty()) {
            co_await asio::post(asio::use_awaitable);
        }
        test.line.send(std::span(packet).subspan<2>());
        test.scanner.send_turn();
        co_await test.until([&test, before] { return test.device->state().line.samples > before; });
    }(*this));
    EXPECT_THAT(phases, testing::Not(Contains(Phase::stalled)));
}

TEST_F(DeviceTest, AScanThatStallsMoreOftenThanItMayHasThePortOpenedAnew) {
    make_device({.recovery = {.attempts = {1ms, 1ms}, .restarts = 0}});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until([&test] { return test.opened >= 2; });
    }(*this));
    EXPECT_THAT(phases, Contains(Phase::stalled));
    EXPECT_THAT(phases, Contains(Phase::backing_off));
}

TEST_F(DeviceTest, APortThatIsNotThereIsAwaited) {
    const auto missing = make_error_code(link::errc::port_not_found);
    open_problem = Problem{missing, "there is no port here", "plug it in"};
    int looks = 0;
    make_device(
        {.recovery = not_again},
        [this, &looks](std::chrono::steady_clock::time_point) -> asio::awaitable<void> {
            if (++looks == 3) {
                open_problem.reset();
            }
            co_return;
        }
    );
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::absent);
        EXPECT_EQ(test.device->state().cause, "there is no port here");
        EXPECT_FALSE(test.device->state().next_attempt) << "it is met when it comes";
        co_await test.until_phase(Phase::scanning);
        EXPECT_FALSE(test.device->state().failing_since);
        EXPECT_EQ(test.device->state().recoveries, 1U);
    }(*this));
    EXPECT_EQ(std::ranges::count(phases, Phase::absent), 1) << "looking again in vain is no news";
}

TEST_F(DeviceTest, ALidarThatIsNotTheOneToHaveIsLeftAlone) {
    int met = 0;
    make_device({.recovery = at_once}, {}, [&met](const protocol::DeviceInfo&) {
        return ++met == 3;
    });
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        EXPECT_EQ(test.device->state().cause, "another lidar is on the port");
        EXPECT_FALSE(test.device->state().info);
        co_await test.until_phase(Phase::scanning);
    }(*this));
    EXPECT_EQ(met, 3);
    EXPECT_EQ(opened, 3);
}

TEST_F(DeviceTest, SaysWhenItIsTriedAgain) {
    scanner.answers = false;
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        const auto& state = test.device->state();
        EXPECT_TRUE(state.next_attempt);
        EXPECT_GE(*state.next_attempt - state.since, 30min) << "half of an hour at least";
        EXPECT_EQ(state.failing_since, state.since);
    }(*this));
}

TEST_F(DeviceTest, AStoppedLidarStaysStoppedThroughARecovery) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_TRUE(co_await test.device->stop());
        test.line.unplug();
        co_await test.until_phase(Phase::backing_off);
        const auto scans = test.scanner.count(Command::express_scan);
        co_await test.until_phase(Phase::idle);
        EXPECT_EQ(test.scanner.count(Command::express_scan), scans);
        EXPECT_EQ(test.device->state().recoveries, 1U);
    }(*this));
}

TEST_F(DeviceTest, AnExceptionOfTheObserverIsAFailureLikeOthers) {
    make_device();
    sweep_throws = true;
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        EXPECT_EQ(test.device->state().cause, "no room for a sweep");
        EXPECT_EQ(test.line.dtr, true) << "the motor turns on";
        EXPECT_THAT(
            test.scanner.since_scan(),
            Contains(testing::Field(&protocol::Request::command, Command::stop))
        ) << "the scan goes on";
        test.sweep_throws = false;
        co_await test.until([&test] { return !test.sweeps.empty(); });
    }(*this));
}

TEST_F(DeviceTest, AnErrorOfTheSystemThatIsThrownIsAFailureLikeOthers) {
    open_throws = std::make_exception_ptr(boost::system::system_error(
        make_error_code(boost::system::errc::too_many_files_open),
        "thread"
    ));
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        test.open_throws = nullptr;
        co_await test.until_phase(Phase::scanning);
    }(*this));
}

TEST_F(DeviceTest, ScansInTheTypicalModeOfALidarThatListsItsModes) {
    scanner.list_modes();
    make_device();
    play(until_phase(Phase::starting));

    EXPECT_EQ(device->state().mode, "Boost");
    EXPECT_EQ(device->state().modes.size(), 3U);
    EXPECT_THAT(scanner.requests, Contains(protocol::express_scan_request(2)));
}

TEST_F(DeviceTest, ScansInTheModeOfAnId) {
    scanner.list_modes();
    make_device({.mode = "1", .recovery = at_once});
    play(until_phase(Phase::starting));

    EXPECT_EQ(device->state().mode, "DenseBoost");
}

TEST_F(DeviceTest, ChangesTheModeOfAnIdleLidarForTheNextStart) {
    make_device({.scan_at_once = false, .recovery = at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::idle);
        const auto changed_mode = co_await test.device->set_mode("standard");
        EXPECT_TRUE(changed_mode);
        EXPECT_EQ(test.device->state().phase, Phase::idle);
        EXPECT_EQ(test.device->state().mode, "Standard");
        const auto refused = co_await test.device->set_mode("Turbo");
        EXPECT_FALSE(refused);
        EXPECT_EQ(refused.error().code, errc::unknown_mode);
    }(*this));
    EXPECT_EQ(scanner.count(Command::scan), 0U);
}

TEST_F(DeviceTest, ScansAllTheSameIfItHasNoSuchModeAndSaysSoUntilItIsToldAnother) {
    make_device({.mode = "Turbo", .recovery = at_once});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_THAT(test.device->state().cause, testing::HasSubstr("no scan mode \"Turbo\""));
        EXPECT_THAT(test.device->state().hint, testing::HasSubstr("Standard"));
        EXPECT_TRUE(co_await test.device->stop());
        EXPECT_THAT(test.device->state().cause, testing::HasSubstr("Turbo"));
        EXPECT_TRUE(co_await test.device->start(""));
        EXPECT_THAT(test.device->state().cause, testing::HasSubstr("Turbo"));
        EXPECT_TRUE(co_await test.device->stop());
        EXPECT_TRUE(co_await test.device->set_mode("Standard"));
        EXPECT_EQ(test.device->state().cause, "");
        EXPECT_TRUE(co_await test.device->start(""));
        EXPECT_EQ(test.device->state().cause, "");
        EXPECT_EQ(test.device->state().mode, "Standard");
    }(*this));
}

TEST_F(DeviceTest, ChangesTheModeOfAScanningLidarAtOnce) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        const auto changed_mode = co_await test.device->set_mode("Standard");
        EXPECT_TRUE(changed_mode);
        EXPECT_EQ(test.device->state().phase, Phase::scanning);
        EXPECT_EQ(test.device->state().mode, "Standard");
    }(*this));
    EXPECT_EQ(scanner.count(Command::scan), 1U);
}

TEST_F(DeviceTest, FindsTheLineSpeedAndGoesThereFirstTheNextTime) {
    scanner.baud = 460800;
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_EQ(test.opened_at, 115200U);
        EXPECT_EQ(test.device->state().line.baud, 460800U);
        test.line.unplug();
        co_await test.until_phase(Phase::backing_off);
        co_await test.until_phase(Phase::scanning);
        EXPECT_EQ(test.opened_at, 460800U);
    }(*this));
}

TEST_F(DeviceTest, LooksAtTheHintedLineSpeedFirst) {
    scanner.baud = 256000;
    make_device({.baud_hints = {256000}, .recovery = at_once});
    play(until_phase(Phase::scanning));
    EXPECT_EQ(opened_at, 256000U);
}

TEST_F(DeviceTest, TalksTheLidarIntoTheLineSpeedThatWasAskedFor) {
    scanner.info.firmware_minor = 30;
    scanner.negotiates = true;
    make_device({.baud = 230400, .recovery = at_once});
    scanner.baud = 115200;
    play(until_phase(Phase::scanning));
    EXPECT_EQ(device->state().line.baud, 230400U);
    EXPECT_EQ(scanner.baud, 230400U);
}

TEST_F(DeviceTest, UsesTheLidarsOwnLineSpeedIfItCannotBeTalkedIntoAnother) {
    make_device({.baud = 230400, .recovery = at_once});
    play(until_phase(Phase::scanning));
    EXPECT_EQ(device->state().line.baud, 115200U);
}

TEST_F(DeviceTest, ANetworkHasNoLineSpeedToFind) {
    line.baud = 0;
    make_device();
    play(until_phase(Phase::scanning));
    EXPECT_EQ(device->state().line.baud, 0U);
}

TEST_F(DeviceTest, TellsTheSpeedOfTheRotationAndTheStateOfTheLine) {
    make_device({.recovery = at_once, .report_interval = 0ms});
    play(until([this] { return sweeps.size() >= 2; }));
    EXPECT_EQ(device->state().rotation.control, SpeedControl::fixed);
    EXPECT_EQ(device->state().line.samples, 3U * 360U);
    EXPECT_GE(device->state().line.bytes, 3U * 360U * 5U);
}

TEST_F(DeviceTest, RefusesASpeedThatCannotBeSet) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_EQ(test.device->set_speed(7.0).error().code, errc::fixed_speed);
        EXPECT_EQ(test.device->set_speed(-1.0).error().code, errc::no_such_speed);
        EXPECT_TRUE(test.device->set_speed(0.0));
    }(*this));
}

TEST_F(DeviceTest, WarnsThatASpeedAskedForAtTheStartCannotBeSet) {
    make_device({.speed_hz = 7.0, .recovery = at_once});
    play(until_phase(Phase::scanning));
    EXPECT_THAT(device->state().rotation.warning, HasSubstr("cannot be changed"));
}

TEST_F(DeviceTest, TellsAnAccessoryBoardTheDutyAlsoInMidScan) {
    scanner.info.model = 0x28;
    scanner.board = protocol::AccessoryBoard{true};
    scanner.turns_at_start = 1;
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_THAT(test.scanner.requests, Contains(protocol::set_motor_pwm_request(660)));
        EXPECT_TRUE(test.device->set_speed(5.0));
        EXPECT_EQ(test.device->state().rotation.wanted_hz, 5.0);
        test.scanner.send_turn();
        test.scanner.send_turn();
        co_await test.until([&test] { return test.sweeps.size() >= 2; });
        EXPECT_EQ(test.device->state().phase, Phase::scanning);
    }(*this));
    EXPECT_THAT(scanner.requests, Contains(protocol::set_motor_pwm_request(330)));
    EXPECT_EQ(scanner.requests.back(), protocol::set_motor_pwm_request(0));
}

TEST_F(DeviceTest, TheSameSpeedAgainDoesNotBeginTheRegulationAnew) {
    scanner.info.model = 0x28;
    scanner.board = protocol::AccessoryBoard{.controls_motor = true};
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        EXPECT_TRUE(test.device->set_speed(5.0));
        const auto told = test.phases.size();
        EXPECT_TRUE(test.device->set_speed(5.0));
        EXPECT_EQ(test.phases.size(), told);
    }(*this));
}

TEST_F(DeviceTest, TellsALidarThatRegulatesItsSpeedTheRpm) {
    scanner.info.model = 0x61;
    scanner.list_modes();
    make_device({.mode = "Standard", .speed_hz = 7.0, .recovery = at_once});
    play(until_phase(Phase::scanning));
    EXPECT_THAT(scanner.requests, Contains(protocol::motor_rpm_request(420)));
    EXPECT_EQ(scanner.requests.back(), protocol::motor_rpm_request(0));
    EXPECT_EQ(scanner.count(Command::set_motor_pwm), 0U);
}

TEST_F(DeviceTest, LeavesTheMotorOfALidarThatSpinsByItselfAlone) {
    scanner.info.model = 0x41;
    make_device();
    play(until_phase(Phase::scanning));
    EXPECT_EQ(scanner.count(Command::set_motor_pwm), 0U);
    EXPECT_EQ(scanner.count(Command::motor_rpm), 0U);
    EXPECT_EQ(scanner.count(Command::get_acc_board_flag), 0U);
}

TEST_F(DeviceTest, AnExaminationHasThePortToItself) {
    scanner.answers = false;
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        const auto diagnosis =
            co_await test.device->diagnose([&test]() -> asio::awaitable<Diagnosis> {
                EXPECT_FALSE(test.device->in_hand());
                EXPECT_EQ(test.device->state().cause, "being examined");
                test.scanner.answers = true;
                co_return a_diagnosis();
            });
        EXPECT_EQ(diagnosis->value().port, "here");
        co_await test.until_phase(Phase::scanning);  // at once, though the retry is an hour away
    }(*this));
}

TEST_F(DeviceTest, ALidarInHandIsNotExaminedFromOutside) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        const auto diagnosis = co_await test.device->diagnose([]() -> asio::awaitable<Diagnosis> {
            ADD_FAILURE() << "the port is in use";
            co_return Diagnosis{};
        });
        EXPECT_TRUE(diagnosis);
        EXPECT_FALSE(*diagnosis) << "its state tells";
    }(*this));
}

TEST_F(DeviceTest, AnExaminationInterruptsAnAttempt) {
    scanner.answers = false;
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::identifying);
        const auto diagnosis = co_await test.device->diagnose([]() -> asio::awaitable<Diagnosis> {
            co_return a_diagnosis();
        });
        EXPECT_EQ(diagnosis->value().port, "here");
    }(*this));
}

TEST_F(DeviceTest, AnExaminationThatFailsIsNoneAndTheLidarIsTriedAgain) {
    scanner.answers = false;
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        const auto diagnosis =
            co_await test.device->diagnose([&test]() -> asio::awaitable<Diagnosis> {
                test.scanner.answers = true;
                throw std::runtime_error("no room for a diagnosis");
                co_return Diagnosis{};
            });
        EXPECT_FALSE(diagnosis);
        co_await test.until_phase(Phase::scanning);
    }(*this));
}

TEST_F(DeviceTest, AnExaminationAskedForDuringAResetFindsTheLidarInHandAfterIt) {
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::scanning);
        test.spawn([](DeviceTest& itself) -> asio::awaitable<void> {
            (void)co_await itself.device->reset();
        }(test));
        co_await test.until_phase(Phase::resetting);
        const auto diagnosis = co_await test.device->diagnose([]() -> asio::awaitable<Diagnosis> {
            ADD_FAILURE() << "the port is in use";
            co_return Diagnosis{};
        });
        EXPECT_TRUE(diagnosis);
        EXPECT_FALSE(*diagnosis) << "its state tells";
    }(*this));
}

TEST_F(DeviceTest, ShuttingDownEndsAnExamination) {
    open_problem = Problem{make_error_code(errc::no_answer), "no such port", "plug it in"};
    make_device({.recovery = not_again});
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::backing_off);
        const auto diagnosis =
            co_await test.device->diagnose([&test]() -> asio::awaitable<Diagnosis> {
                asio::post(test.context, [&test] { test.device->shut_down(); });
                async::Notifier never(test.context.get_executor());
                co_await never.wait_until(std::chrono::steady_clock::time_point::max());
                co_return Diagnosis{};
            });
        EXPECT_FALSE(diagnosis);
        EXPECT_EQ(diagnosis.error().code, errc::shutting_down);
    }(*this));
}

TEST_F(DeviceTest, ShuttingDownEndsTheWaitOfACommand) {
    scanner.turns_at_start = 0;
    make_device();
    play([](DeviceTest& test) -> asio::awaitable<void> {
        co_await test.until_phase(Phase::starting);
        asio::post(test.context, [&test] { test.device->shut_down(); });
        const auto started = co_await test.device->start("");
        EXPECT_FALSE(started);
        EXPECT_EQ(started.error().code, errc::shutting_down);
    }(*this));
}

}  // namespace
}  // namespace sweepcast::device
