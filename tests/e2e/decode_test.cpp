// `sweepcast decode`: recorded streams come out of the real program as the vectors say.
#include "tests/e2e/gateway.hpp"
#include "tests/support/vector.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace sweepcast::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* header = "angle_z_q14,dist_mm_q2,quality,flag\n";

std::string number(protocol::AnswerType type) {
    return std::to_string(static_cast<int>(type) - 0x81 + 81);
}

/// What should be printed for a vector, in its own units.
std::string csv_of(const Vector& vector) {
    std::string text = header;
    for (const auto& sample : vector.expected.samples) {
        const bool nonsense = (sample.distance.raw & 0x80000000U) != 0;
        text += std::to_string(sample.angle.raw) + "," +
                std::to_string(nonsense ? 0 : sample.distance.raw) + "," +
                std::to_string(sample.quality) + "," + std::to_string(sample.flag) + "\n";
    }
    return text;
}

struct Outcome {
    int exit_code{};
    std::string output, log;
};

Outcome run(const std::vector<std::string>& arguments) {
    Process process(arguments);
    const int exit_code = process.wait();
    return {exit_code, process.rest_of_output(), process.rest_of_log()};
}

Outcome shell(const std::string& script) {
    return run({"/bin/sh", "-c", script});
}

class DecodeVectorTest : public testing::TestWithParam<const char*> {};

TEST_P(DecodeVectorTest, AFileComesOutAsItsVectorSays) {
    const auto vector = load_vector(GetParam());
    const auto outcome = run(
        {program(),
         "decode",
         "--type",
         number(vector.type),
         "--sample-us",
         std::to_string(vector.settings.sample_duration / std::chrono::microseconds(1)),
         vector_path(GetParam())}
    );
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_TRUE(outcome.output == csv_of(vector)) << outcome.output.substr(0, 300);
    EXPECT_THAT(outcome.log, HasSubstr("0 checksum errors, 0 bytes skipped, 0 packets lost"));
}

INSTANTIATE_TEST_SUITE_P(
    Vectors,
    DecodeVectorTest,
    testing::Values("81_room", "82_room", "83_room", "84_extremes", "85_speed", "86_room"),
    [](const auto& tested) { return std::string("v") + tested.param; }
);

TEST(DecodeTest, APipeIsDecodedAndItsDamageSummedUp) {
    const auto outcome =
        shell("cat " + vector_path("84_damage") + " | " + program() + " decode --type 0x84");
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output, StartsWith(header));
    EXPECT_THAT(outcome.log, HasSubstr("5088 samples; 4 checksum errors, 255 bytes skipped"));
}

TEST(DecodeTest, UnitsAreDegreesAndMillimetres) {
    const auto outcome =
        run({program(), "decode", "--type", "dense", "--units", vector_path("85_room")});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.output, StartsWith("angle_deg,distance_mm,quality,flag\n"));
    const auto first = load_vector("85_room").expected.samples.front();
    const auto line = outcome.output.substr(outcome.output.find('\n') + 1);
    double degrees = 0;
    double millimetres = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,", &degrees, &millimetres), 2);
    EXPECT_NEAR(degrees, first.angle.degrees(), 0.00005);
    EXPECT_DOUBLE_EQ(millimetres, first.distance.millimetres());
}

TEST(DecodeTest, SamplesComeOutWhileTheInputGoesOn) {
    const auto fifo =
        std::filesystem::temp_directory_path() / ("sweepcast-decode-" + std::to_string(::getpid()));
    ASSERT_EQ(::mkfifo(fifo.c_str(), 0600), 0);
    Process process({program(), "decode", "--type", "81", fifo.string()});
    std::ofstream input(fifo, std::ios::binary);
    std::filesystem::remove(fifo);
    const auto vector = load_vector("81_room");
    const std::string bytes(vector.bytes.begin(), vector.bytes.end());
    input.write(bytes.data(), static_cast<std::streamsize>(bytes.size())).flush();
    const auto all = csv_of(vector);
    const auto last = all.rfind('\n', all.size() - 2) + 1;
    process.wait_for_output(all.substr(last, all.size() - 1 - last));
    input.close();
    EXPECT_EQ(process.wait(), 0);
}

TEST(DecodeTest, AReaderThatHasHadEnoughIsNoNews) {
    const auto vector = vector_path("84_room");
    const auto outcome = shell(
        "while cat " + vector + " 2>/dev/null; do :; done | " + program() +
        " decode --type ultra | head -n 1"
    );
    EXPECT_EQ(outcome.output, header);
    EXPECT_EQ(outcome.log, "");
}

TEST(DecodeTest, AClosedOutputIsToldAndEndsIt) {
    const auto outcome =
        shell(program() + " decode --type ultra " + vector_path("84_room") + " >&-");
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.log, HasSubstr("cannot write to standard output"));
}

TEST(DecodeTest, AnotherTypeThanTheStreamsIsPointedOut) {
    const auto outcome = run({program(), "decode", "--type", "83", vector_path("84_room")});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.log, HasSubstr("no samples of type 0x83 (hq) in 7920 bytes"));
    EXPECT_THAT(outcome.log, HasSubstr("0x86 (ultra-dense)"));
}

}  // namespace
}  // namespace sweepcast::test
