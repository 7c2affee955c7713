// A diagnosis grows finding by finding, and ends with the first that failed.
#include "driver/diagnosis/finding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace sweepcast::diagnosis {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Finding finding(Step step, Verdict verdict, std::string cause = "") {
    return {step, verdict, "seen", std::move(cause), {"why"}, {"do this"}};
}

TEST(Chain, StandsInTheOrderOfItsSteps) {
    std::set<std::string_view> ids;
    for (const auto& names_of_step : chain) {
        EXPECT_EQ(&names(names_of_step.step), &names_of_step);
        ids.insert(names_of_step.id);
    }
    EXPECT_EQ(ids.size(), chain.size());
}

TEST(DiagnosisBuilder, HasAllWellWithoutACause) {
    DiagnosisBuilder builder("/dev/ttyUSB0", {});
    for (const auto& step : chain) {
        EXPECT_TRUE(builder.add(finding(step.step, Verdict::ok)));
    }
    const auto diagnosis = builder.finish();
    EXPECT_EQ(diagnosis.port, "/dev/ttyUSB0");
    EXPECT_EQ(diagnosis.verdict(), Verdict::ok);
    EXPECT_EQ(diagnosis.cause, "");
    EXPECT_EQ(diagnosis.checks.size(), chain.size());
}

TEST(DiagnosisBuilder, TellsTheCauseOfTheFailureAndWhatWasNotRun) {
    DiagnosisBuilder builder("p", {});
    EXPECT_TRUE(builder.add(finding(Step::port, Verdict::ok)));
    EXPECT_FALSE(builder.add(finding(Step::permission, Verdict::failed, "no right")));
    const auto diagnosis = builder.finish();
    EXPECT_EQ(diagnosis.verdict(), Verdict::failed);
    EXPECT_EQ(diagnosis.cause, "no right");
    EXPECT_THAT(diagnosis.likely_causes, ElementsAre("why"));
    EXPECT_THAT(diagnosis.next_steps, ElementsAre("do this"));
    ASSERT_EQ(diagnosis.checks.size(), chain.size());
    EXPECT_EQ(diagnosis.checks[2].id, "holder");
    EXPECT_TRUE(std::ranges::all_of(
        diagnosis.checks.begin() + 2,
        diagnosis.checks.end(),
        [](const Check& check) { return check.verdict == Verdict::not_run; }
    ));
}

TEST(DiagnosisBuilder, AFailureExplainsMoreThanAnEarlierWarning) {
    DiagnosisBuilder builder("p", {});
    EXPECT_TRUE(builder.add(finding(Step::health, Verdict::warning, "warm")));
    EXPECT_TRUE(builder.add(finding(Step::modes, Verdict::warning, "odd")));
    EXPECT_FALSE(builder.add(finding(Step::motor, Verdict::failed, "stalled")));
    EXPECT_EQ(builder.finish().cause, "stalled");
}

TEST(DiagnosisBuilder, OfWarningsTheFirstIsExplained) {
    DiagnosisBuilder builder("p", {});
    EXPECT_TRUE(builder.add(finding(Step::health, Verdict::warning, "warm")));
    EXPECT_TRUE(builder.add(finding(Step::quality, Verdict::warning, "noisy")));
    const auto diagnosis = builder.finish();
    EXPECT_EQ(diagnosis.verdict(), Verdict::warning);
    EXPECT_EQ(diagnosis.cause, "warm");
}

TEST(DiagnosisBuilder, LeavesOutStepsThatHaveNoMeaning) {
    DiagnosisBuilder builder("udp://10.0.0.2:8089", {});
    EXPECT_FALSE(builder.add(finding(Step::open, Verdict::failed, "refused")));
    const std::array without{Step::speed};
    const auto diagnosis = builder.finish(without);
    EXPECT_EQ(diagnosis.checks.front().id, "open");
    EXPECT_EQ(diagnosis.checks.back().id, "quality");
}

TEST(DiagnosisBuilder, TellsEveryCheckAtOnce) {
    std::vector<std::string> told;
    DiagnosisBuilder builder("p", [&](const Check& check) { told.push_back(check.id); });
    EXPECT_THAT(told, IsEmpty());
    builder.add(finding(Step::port, Verdict::ok));
    EXPECT_THAT(told, ElementsAre("port"));
    builder.add(finding(Step::permission, Verdict::failed));
    const auto diagnosis = builder.finish();
    ASSERT_EQ(told.size(), diagnosis.checks.size());
    EXPECT_EQ(told.back(), "speed");
}

}  // namespace
}  // namespace sweepcast::diagnosis
