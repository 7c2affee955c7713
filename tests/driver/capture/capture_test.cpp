// Captures written and read again; cut anywhere; damaged anywhere.
#include "driver/capture/capture_reader.hpp"
#include "driver/capture/capture_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

namespace sweepcast::capture {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using End = CaptureReader::End;
using Bytes = std::vector<std::uint8_t>;

CaptureHeader header() {
    CaptureHeader made;
    made.model = "A1M8";
    made.answer_type = protocol::AnswerType::express;
    made.sample_duration = 250us;
    made.baud = 115200;
    return made;
}

std::vector<CaptureRecord> records() {
    return {
        {Direction::to_device, 0ns, {0xA5, 0x82}},
        {Direction::from_device, 1'500'000ns, {0xA5, 0x5A, 0x00, '\n', 0xFF}},
        {Direction::from_device, 1'500'000ns, {0x3C}},
        {Direction::from_device, 9'000'000'000ns, Bytes(300, 0x55)}};
}

std::string written(const std::vector<CaptureRecord>& all) {
    std::ostringstream out;
    CaptureWriter writer(out, header());
    for (const auto& record : all) {
        EXPECT_TRUE(writer.append(record.direction, record.at, record.bytes));
    }
    return out.str();
}

struct Outcome {
    std::vector<CaptureRecord> records;
    End end{};
};

Outcome read(const std::string& file) {
    std::istringstream in(file);
    auto reader = CaptureReader::open(in);
    if (!reader) {
        throw std::runtime_error(reader.error().cause);
    }
    Outcome outcome;
    while (auto record = reader->next()) {
        outcome.records.push_back(std::move(*record));
    }
    outcome.end = reader->end();
    EXPECT_FALSE(reader->next()) << "the end is the end";
    return outcome;
}

std::size_t size_of_header() {
    return written({}).size();
}

TEST(CaptureTest, IsReadAsItWasWritten) {
    const auto file = written(records());
    std::istringstream in(file);
    const auto reader = CaptureReader::open(in);
    ASSERT_TRUE(reader);
    EXPECT_EQ(reader->header(), header());
    const auto outcome = read(file);
    EXPECT_EQ(outcome.records, records());
    EXPECT_EQ(outcome.end, End::whole);
}

TEST(CaptureTest, MayBeEmpty) {
    const auto outcome = read(written({}));
    EXPECT_TRUE(outcome.records.empty());
    EXPECT_EQ(outcome.end, End::whole);
}

TEST(CaptureTest, IsAsItIsDocumented) {
    const auto file = written({{Direction::from_device, 0x0102030405ns, {0xA5, 0x5A}}});
    EXPECT_EQ(file.substr(0, file.find('\n')), "sweepcast capture 1");
    const std::string
        expected{'<', 5, 4, 3, 2, 1, 0, 0, 0, 2, 0, 0, 0, static_cast<char>(0xA5), 'Z'};
    EXPECT_EQ(file.substr(size_of_header()), expected);
    EXPECT_TRUE(is_capture(file));
    EXPECT_FALSE(is_capture("sweepcast cap"));
}

TEST(CaptureTest, SplitsWhatIsLongerThanARecordMayBe) {
    Bytes much(2 * most_record_bytes + 7);
    for (std::size_t i = 0; i < much.size(); ++i) {
        much[i] = static_cast<std::uint8_t>(i * 31);
    }
    const auto outcome = read(written({{Direction::from_device, 5ns, much}}));
    ASSERT_EQ(outcome.records.size(), 3U);
    Bytes joined;
    for (const auto& record : outcome.records) {
        EXPECT_EQ(record.at, 5ns);
        joined.insert(joined.end(), record.bytes.begin(), record.bytes.end());
    }
    EXPECT_EQ(joined, much);
}

TEST(CaptureTest, NeverGoesBackInTime) {
    const auto outcome =
        read(written({{Direction::from_device, 9ns, {1}}, {Direction::from_device, 3ns, {2}}}));
    ASSERT_EQ(outcome.records.size(), 2U);
    EXPECT_EQ(outcome.records[1].at, 9ns);
}

TEST(CaptureTest, CutAnywhereGivesWhatIsWholeAndSaysSo) {
    const auto file = written(records());
    std::vector<std::size_t> borders{size_of_header()};
    for (const auto& record : records()) {
        borders.push_back(borders.back() + record_head_bytes + record.bytes.size());
    }
    for (std::size_t size = size_of_header(); size <= file.size(); ++size) {
        const auto whole = static_cast<std::size_t>(
            std::upper_bound(borders.begin(), borders.end(), size) - borders.begin() - 1
        );
        const auto outcome = read(file.substr(0, size));
        ASSERT_EQ(outcome.records.size(), whole) << size;
        ASSERT_EQ(outcome.end, borders[whole] == size ? End::whole : End::cut_short) << size;
    }
}

TEST(CaptureTest, CutInItsHeaderIsNone) {
    const auto file = written({});
    for (std::size_t size = 0; size < file.size(); ++size) {
        std::istringstream in(file.substr(0, size));
        ASSERT_FALSE(CaptureReader::open(in)) << size;
    }
}

class DamagedRecordTest : public testing::TestWithParam<std::pair<std::size_t, int>> {};

TEST_P(DamagedRecordTest, EndsTheCaptureThere) {
    auto file = written(records());
    const auto third = size_of_header() + 2 * record_head_bytes + 2 + 5;
    file[third + GetParam().first] = static_cast<char>(GetParam().second);
    const auto outcome = read(file);
    EXPECT_EQ(outcome.records.size(), 2U);
    EXPECT_EQ(outcome.end, End::damaged);
}

INSTANTIATE_TEST_SUITE_P(
    PlacesAndValues,
    DamagedRecordTest,
    testing::Values(
        std::pair{0U, int{'='}},  // direction
        std::pair{0U, 0},
        std::pair{3U, 0},     // earlier than the record before
        std::pair{7U, 0x80},  // in some thousand years
        std::pair{8U, 0xFF},
        std::pair{9U, 0},     // nothing at all
        std::pair{12U, 1},    // 16 MB
        std::pair{12U, 0xFF}  // 4 GB
    )
);

TEST(CaptureTest, AnyBytesAreSurvived) {
    std::mt19937 random(7);
    std::uniform_int_distribution<int> byte(0, 255);
    const auto file = written(records());
    for (int round = 0; round < 2000; ++round) {
        auto damaged = file;
        for (int i = 0; i < 4; ++i) {
            std::uniform_int_distribution<std::size_t> place(size_of_header(), file.size() - 1);
            damaged[place(random)] = static_cast<char>(byte(random));
        }
        const auto outcome = read(damaged);
        ASSERT_NE(outcome.end, End::not_yet);
        ASSERT_LE(outcome.records.size(), file.size() / record_head_bytes);
    }
}

TEST(CaptureTest, OfALaterVersionSaysSo) {
    std::istringstream in("sweepcast capture 2\n{}\n");
    const auto reader = CaptureReader::open(in);
    ASSERT_FALSE(reader);
    EXPECT_THAT(reader.error().cause, HasSubstr("version"));
}

TEST(CaptureTest, IsNoneWithoutItsFirstLine) {
    for (const auto* text : {"", "\n", "sweepcast capture", "A5 5A", "sweepcast  capture 1\n"}) {
        std::istringstream in(text);
        const auto reader = CaptureReader::open(in);
        ASSERT_FALSE(reader) << text;
        EXPECT_THAT(reader.error().cause, HasSubstr("no capture"));
    }
}

TEST(CaptureTest, WithAHeaderWithoutEndIsRefusedEarly) {
    std::istringstream in("sweepcast capture 1\n" + std::string(1 << 20, ' '));
    ASSERT_FALSE(CaptureReader::open(in));
    ASSERT_TRUE(in.good()) << "it was read to its end";
    EXPECT_LT(in.tellg(), 2 * static_cast<std::streamoff>(most_header_bytes));
}

TEST(CaptureTest, TellsWhenItCannotBeWritten) {
    std::ostringstream out;
    CaptureWriter writer(out, header());
    EXPECT_TRUE(writer.ok());
    const auto size = out.str().size();
    out.setstate(std::ios::badbit);
    EXPECT_FALSE(writer.append(Direction::from_device, 0ns, Bytes{1}));
    EXPECT_FALSE(writer.ok());
    EXPECT_EQ(out.str().size(), size);
}

}  // namespace
}  // namespace sweepcast::capture
