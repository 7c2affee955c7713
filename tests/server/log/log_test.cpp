// What reaches standard error.
#include "server/log/log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace sweepcast::log {
namespace {

using testing::EndsWith;

TEST(Log, MakesWhatAPeerSaysPrintable) {
    const auto log = make_logger("lidar \x1b[2J");
    testing::internal::CaptureStderr();
    log->warn("{} is gone", "A\x1b]0;title\x07\nforged line\xff");
    EXPECT_THAT(
        testing::internal::GetCapturedStderr(),
        EndsWith("[lidar \\u001b[2J] A\\u001b]0;title\\u0007\\nforged line\\xff is gone\n")
    );
}

}  // namespace
}  // namespace sweepcast::log
