// OutputFile: files, pipes and full disks of this machine.
#include "server/cli/output_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <unistd.h>

namespace sweepcast::cli {
namespace {

using testing::HasSubstr;

class OutputFileTest : public testing::Test {
protected:
    OutputFileTest() {
        auto pattern = (std::filesystem::temp_directory_path() / "sweepcast-test-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr) {
            throw std::runtime_error("no scratch directory");
        }
        folder_ = pattern;
        path_ = (folder_ / "file").string();
    }
    ~OutputFileTest() override {
        std::error_code ignored;  // a leftover in /tmp fails no test
        std::filesystem::remove_all(folder_, ignored);
    }

    [[nodiscard]] std::string content() const {
        std::ostringstream all;
        all << std::ifstream(path_, std::ios::binary).rdbuf();
        return all.str();
    }

    std::filesystem::path folder_;
    std::string path_;
};

TEST_F(OutputFileTest, HoldsWhatWasWritten) {
    auto file = OutputFile::create(path_, Existing::refuse);
    ASSERT_TRUE(file) << file.error().cause;
    const std::string much(100'000, 'x');
    file->stream() << "first" << std::flush;
    EXPECT_EQ(content(), "first") << "flushed is written";
    file->stream() << much;
    EXPECT_FALSE(file->close());
    EXPECT_EQ(content(), "first" + much);
}

TEST_F(OutputFileTest, ReplacesOnlyWhenTold) {
    std::ofstream(path_) << "precious";
    EXPECT_THAT(check_output(path_, Existing::refuse).error().cause, HasSubstr("exists already"));
    const auto refused = OutputFile::create(path_, Existing::refuse);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().cause, HasSubstr("exists already"));
    EXPECT_EQ(content(), "precious");
    EXPECT_TRUE(check_output(path_, Existing::replace));
    auto replaced = OutputFile::create(path_, Existing::replace);
    ASSERT_TRUE(replaced);
    EXPECT_FALSE(replaced->close());
    EXPECT_EQ(content(), "");
}

TEST_F(OutputFileTest, CreatesNothingThroughADanglingLink) {
    std::filesystem::create_symlink(folder_ / "elsewhere", path_);
    EXPECT_FALSE(OutputFile::create(path_, Existing::refuse));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "elsewhere"));
}

TEST_F(OutputFileTest, TellsWhyItCannotBe) {
    for (const auto& path : {folder_.string(), (folder_ / "no" / "file").string()}) {
        EXPECT_FALSE(check_output(path, Existing::replace)) << path;
        const auto made = OutputFile::create(path, Existing::replace);
        ASSERT_FALSE(made) << path;
        EXPECT_THAT(made.error().cause, HasSubstr("cannot write " + path));
        EXPECT_FALSE(made.error().hint.empty());
    }
}

TEST_F(OutputFileTest, TellsThatTheDiskIsFull) {
    EXPECT_TRUE(check_output("/dev/full", Existing::refuse)) << "a device is no file to keep";
    auto file = OutputFile::create("/dev/full", Existing::refuse);
    ASSERT_TRUE(file);
    file->stream() << "text";
    EXPECT_FALSE(file->error());
    file->stream().flush();
    EXPECT_FALSE(file->stream().good());
    EXPECT_EQ(file->error(), boost::system::errc::no_space_on_device);
    EXPECT_EQ(file->close(), boost::system::errc::no_space_on_device);
}

}  // namespace
}  // namespace sweepcast::cli
