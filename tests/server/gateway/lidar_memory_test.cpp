// LidarMemory: line speeds from one run to the next, and files that are not what they should be.
#include "server/gateway/lidar_memory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace sweepcast::gateway {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LidarMemoryTest : public testing::Test {
protected:
    void SetUp() override {
        std::string path = (fs::temp_directory_path() / "sweepcast-memory-XXXXXX").string();
        ASSERT_NE(mkdtemp(path.data()), nullptr);
        folder = path;
        file = folder / "below" / "lidars.json";
    }
    void TearDown() override { fs::remove_all(folder); }

    void put(const std::string& text) const {
        fs::create_directories(file.parent_path());
        std::ofstream(file) << text;
    }

    fs::path folder;
    fs::path file;
};

TEST_F(LidarMemoryTest, RemembersOverARestart) {
    LidarMemory first;
    ASSERT_TRUE(first.open(file));
    ASSERT_TRUE(first.note("AAAA", "/dev/ttyUSB0", 460800));
    ASSERT_TRUE(first.note("BBBB", "/dev/ttyUSB1", 256000));
    LidarMemory second;
    ASSERT_TRUE(second.open(file));
    EXPECT_THAT(second.baud_hints("/dev/ttyUSB0"), ElementsAre(460800, 256000));
    EXPECT_THAT(second.baud_hints("/dev/ttyUSB1"), ElementsAre(256000, 460800));
}

TEST_F(LidarMemoryTest, AnUnknownPortGetsTheCommonestSpeedFirst) {
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    ASSERT_TRUE(memory.note("AAAA", "/dev/ttyUSB0", 460800));
    ASSERT_TRUE(memory.note("BBBB", "/dev/ttyUSB1", 256000));
    ASSERT_TRUE(memory.note("CCCC", "/dev/ttyUSB2", 256000));
    EXPECT_THAT(memory.baud_hints("/dev/ttyUSB9"), ElementsAre(256000, 460800));
}

TEST_F(LidarMemoryTest, FollowsALidarToAnotherPort) {
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    ASSERT_TRUE(memory.note("AAAA", "/dev/ttyUSB0", 460800));
    ASSERT_TRUE(memory.note("BBBB", "/dev/ttyUSB1", 256000));
    ASSERT_TRUE(memory.note("AAAA", "/dev/ttyUSB1", 460800));
    EXPECT_THAT(memory.baud_hints("/dev/ttyUSB1"), ElementsAre(460800, 256000));
}

TEST_F(LidarMemoryTest, KnowsWhichLidarAPortNamesWhereverThatWent) {
    LidarMemory first;
    ASSERT_TRUE(first.open(file));
    ASSERT_TRUE(first.note("AAAA", "/dev/ttyUSB0", 460800, "/dev/ttyUSB0"));
    ASSERT_TRUE(first.note("AAAA", "/dev/ttyUSB1", 460800, "/dev/ttyUSB0"));
    LidarMemory second;
    ASSERT_TRUE(second.open(file));
    EXPECT_EQ(second.lidar_named_by("/dev/ttyUSB0"), (RememberedLidar{"AAAA", 460800}));
    EXPECT_EQ(second.lidar_named_by("/dev/ttyUSB1"), std::nullopt);
    EXPECT_THAT(second.baud_hints("/dev/ttyUSB0"), ElementsAre(460800));
}

TEST_F(LidarMemoryTest, ALidarThatNobodyNamedIsNamedByNoPort) {
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    ASSERT_TRUE(memory.note("AAAA", "/dev/ttyUSB0", 460800));
    EXPECT_EQ(memory.lidar_named_by("/dev/ttyUSB0"), std::nullopt);
    EXPECT_EQ(memory.lidar_named_by(""), std::nullopt);
}

TEST_F(LidarMemoryTest, APseudoTerminalNamesNobodyForItsNumberIsGivenAgain) {
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    ASSERT_TRUE(memory.note("AAAA", "/dev/pts/5", 460800, "/dev/pts/5"));
    EXPECT_EQ(memory.lidar_named_by("/dev/pts/5"), std::nullopt);
    EXPECT_THAT(memory.baud_hints("/dev/pts/5"), ElementsAre(460800));
}

TEST_F(LidarMemoryTest, ALidarKeepsItsNameInARunInWhichNobodyNamesIt) {
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    ASSERT_TRUE(memory.note("AAAA", "/dev/ttyUSB0", 460800, "/dev/ttyUSB0"));
    ASSERT_TRUE(memory.note("AAAA", "/dev/ttyUSB1", 460800));
    EXPECT_EQ(memory.lidar_named_by("/dev/ttyUSB0")->serial, "AAAA");
}

TEST_F(LidarMemoryTest, APortNamesTheLidarThatTookTheOthersPlace) {
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    ASSERT_TRUE(memory.note("AAAA", "/dev/ttyUSB0", 460800, "/dev/ttyUSB0"));
    ASSERT_TRUE(memory.note("BBBB", "/dev/ttyUSB0", 256000, "/dev/ttyUSB0"));
    EXPECT_EQ(memory.lidar_named_by("/dev/ttyUSB0")->serial, "BBBB");
}

TEST_F(LidarMemoryTest, TwoLidarsOfOneSerialNumberAreNotTakenForEachOther) {
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    for (const auto* port : {"/dev/ttyUSB0", "/dev/ttyUSB1", "/dev/ttyUSB0"}) {
        ASSERT_TRUE(memory.note("0000", port, 460800, port));
    }
    EXPECT_EQ(memory.lidar_named_by("/dev/ttyUSB0"), std::nullopt);
    EXPECT_EQ(memory.lidar_named_by("/dev/ttyUSB1"), std::nullopt);
}

TEST_F(LidarMemoryTest, WithoutAFileNothingIsRemembered) {
    LidarMemory memory;
    EXPECT_TRUE(memory.note("AAAA", "/dev/ttyUSB0", 460800));
    EXPECT_THAT(memory.baud_hints("/dev/ttyUSB0"), IsEmpty());
}

class DamagedMemory : public LidarMemoryTest, public testing::WithParamInterface<const char*> {};

TEST_P(DamagedMemory, IsToldAndBegunAnew) {
    put(GetParam());
    LidarMemory memory;
    const auto opened = memory.open(file);
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().cause, HasSubstr("lidars.json"));
    EXPECT_TRUE(memory.note("AAAA", "/dev/ttyUSB0", 460800));
    EXPECT_TRUE(LidarMemory().open(file));
}

INSTANTIATE_TEST_SUITE_P(
    Texts,
    DamagedMemory,
    testing::Values("{", "[]", "null", "{\"lidars\": 3}", "\x01\x02", "{}")
);

TEST_F(LidarMemoryTest, EntriesThatMakeNoSenseAreLeftOut) {
    put(R"({"lidars": [
        null, 3, {}, {"serial": 1, "port": "p", "baud": 9600}, {"serial": "A", "port": "p"},
        {"serial": "B", "port": "p", "baud": -1}, {"serial": "C", "port": "p", "baud": 1e99},
        {"serial": "D", "port": "p", "baud": 256000}]})");
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    EXPECT_THAT(memory.baud_hints("p"), ElementsAre(256000));
}

TEST_F(LidarMemoryTest, AFileTooLargeIsNotRead) {
    put(std::string(300 * 1024, ' '));
    EXPECT_THAT(LidarMemory().open(file).error().cause, HasSubstr("too large"));
}

TEST_F(LidarMemoryTest, RemembersAThousandLidarsAndNoMore) {
    constexpr std::uint32_t most = 1000;
    std::string list;
    for (std::uint32_t i = 1; i <= most + 1; ++i) {  // each at a speed of its own
        const auto number = std::to_string(i);
        list += std::string(list.empty() ? "" : ",") + R"({"serial": ")" + number +
                R"(", "port": "p", "baud": )" + number + "}";
    }
    put(R"({"lidars": [)" + list + "]}");
    LidarMemory memory;
    ASSERT_TRUE(memory.open(file));
    EXPECT_EQ(memory.baud_hints("p").size(), most);
    EXPECT_TRUE(memory.note("AAAA", "q", 460800));
    EXPECT_EQ(memory.baud_hints("p").size(), most);
}

TEST_F(LidarMemoryTest, AFolderInItsPlaceIsTold) {
    fs::create_directories(file);
    LidarMemory memory;
    EXPECT_FALSE(memory.open(file));
    const auto noted = memory.note("AAAA", "/dev/ttyUSB0", 460800);
    ASSERT_FALSE(noted);
    EXPECT_THAT(noted.error().hint, HasSubstr("--state-dir"));
}

TEST_F(LidarMemoryTest, SaysWhyTheFileCannotBeWritten) {
    std::ofstream(folder / "below") << "a file where the folder should be";
    LidarMemory no_folder;
    ASSERT_TRUE(no_folder.open(file));
    const auto in_no_folder = no_folder.note("AAAA", "/dev/ttyUSB0", 460800);
    ASSERT_FALSE(in_no_folder);
    EXPECT_THAT(in_no_folder.error().cause, HasSubstr("Not a directory"));
    fs::create_directories(folder / "lidars.json.new");
    LidarMemory no_file;
    ASSERT_TRUE(no_file.open(folder / "lidars.json"));
    const auto in_no_file = no_file.note("AAAA", "/dev/ttyUSB0", 460800);
    ASSERT_FALSE(in_no_file);
    EXPECT_THAT(in_no_file.error().cause, HasSubstr("Is a directory"));
}

}  // namespace
}  // namespace sweepcast::gateway
