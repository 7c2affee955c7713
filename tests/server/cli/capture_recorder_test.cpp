// CaptureRecorder: nothing that was said is lost before there is a file to say it in.
#include "server/cli/capture_recorder.hpp"

#include "driver/capture/capture_reader.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace sweepcast::cli {
namespace {

using namespace std::chrono_literals;
using capture::CaptureRecord;
using capture::Direction;
using Bytes = std::vector<std::uint8_t>;

const CaptureRecorder::Moment start{1000s};

capture::CaptureHeader header() {
    capture::CaptureHeader made;
    made.model = "A1M8";
    made.answer_type = protocol::AnswerType::express;
    return made;
}

std::vector<CaptureRecord> records_in(std::istream& file) {
    auto reader = capture::CaptureReader::open(file);
    std::vector<CaptureRecord> records;
    while (auto record = reader->next()) {
        records.push_back(std::move(*record));
    }
    EXPECT_EQ(reader->end(), capture::CaptureReader::End::whole);
    return records;
}

TEST(CaptureRecorderTest, WritesFirstWhatWasKept) {
    CaptureRecorder recorder;
    std::stringstream file;
    EXPECT_TRUE(recorder.record(Direction::to_device, start, Bytes{0xA5, 0x50}));
    EXPECT_TRUE(recorder.record(Direction::from_device, start + 3ms, Bytes{1, 2, 3}));
    EXPECT_TRUE(recorder.begin(file, header()));
    EXPECT_TRUE(recorder.record(Direction::from_device, start + 5ms, Bytes{4}));
    EXPECT_EQ(recorder.bytes(), 4U);
    EXPECT_EQ(
        records_in(file),
        (std::vector<CaptureRecord>{
            {Direction::to_device, 0ns, {0xA5, 0x50}},
            {Direction::from_device, 3ms, {1, 2, 3}},
            {Direction::from_device, 5ms, {4}}})
    );
}

TEST(CaptureRecorderTest, TellsWhenItBegan) {
    CaptureRecorder recorder;
    std::stringstream file;
    EXPECT_TRUE(recorder.record(Direction::to_device, start, Bytes{1}));
    EXPECT_TRUE(recorder.begin(file, header()));
    const auto read = capture::CaptureReader::open(file);
    EXPECT_THAT(
        read->header().started,
        testing::MatchesRegex("20..-..-..T..:..:..\\.[0-9][0-9][0-9]Z")
    );
    EXPECT_EQ(read->header().model, "A1M8");
}

TEST(CaptureRecorderTest, ForgetsWhatWasSaidAtAWrongSpeed) {
    CaptureRecorder recorder;
    std::stringstream file;
    EXPECT_TRUE(recorder.record(Direction::from_device, start, Bytes{0xFF, 0xFE}));
    recorder.forget();
    EXPECT_TRUE(recorder.record(Direction::to_device, start + 1s, Bytes{1}));
    EXPECT_TRUE(recorder.begin(file, header()));
    recorder.forget();  // too late for that
    EXPECT_TRUE(recorder.record(Direction::from_device, start + 2s, Bytes{2}));
    EXPECT_EQ(recorder.bytes(), 1U);
    EXPECT_EQ(
        records_in(file),
        (std::vector<CaptureRecord>{
            {Direction::to_device, 0ns, {1}},
            {Direction::from_device, 1s, {2}}})
    );
}

TEST(CaptureRecorderTest, KeepsNoMoreThanItsBound) {
    CaptureRecorder recorder;
    const Bytes block(1 << 20, 0x55);
    for (std::size_t kept = 0; kept < CaptureRecorder::most_kept_bytes; kept += block.size()) {
        EXPECT_TRUE(recorder.record(Direction::from_device, start, block));
    }
    EXPECT_FALSE(recorder.record(Direction::from_device, start, Bytes{1}));
    EXPECT_FALSE(recorder.ok());
    EXPECT_EQ(recorder.bytes(), CaptureRecorder::most_kept_bytes);
}

TEST(CaptureRecorderTest, ADiskThatIsFullIsToldAtOnce) {
    CaptureRecorder recorder;
    std::stringstream file;
    EXPECT_TRUE(recorder.begin(file, header()));
    file.setstate(std::ios::badbit);
    EXPECT_FALSE(recorder.record(Direction::from_device, start, Bytes{1}));
    EXPECT_EQ(recorder.bytes(), 0U);
}

}  // namespace
}  // namespace sweepcast::cli
