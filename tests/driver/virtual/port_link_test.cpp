// PortLink: made, replaced and removed only where that hurts nobody.
#include "driver/virtual/port_link.hpp"

#include "driver/virtual/error.hpp"
#include "tests/driver/virtual/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::virtual_lidar {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class PortLinkTest : public testing::Test {
protected:
    ScratchFolder folder_;
    std::string port_ = folder_.write("port", "");
    std::string other_port_ = folder_.write("other_port", "");
    std::string path_ = folder_.path("link");
};

TEST_F(PortLinkTest, LinksToThePortForAsLongAsItLives) {
    {
        const auto link = PortLink::create(path_, port_);
        ASSERT_TRUE(link) << link.error().cause;
        EXPECT_EQ(link->path(), path_);
        EXPECT_EQ(fs::read_symlink(path_), port_);
    }
    EXPECT_FALSE(fs::is_symlink(path_));
}

TEST_F(PortLinkTest, ReplacesTheLinkOfAnInstanceThatIsGone) {
    fs::create_symlink(folder_.path("gone"), path_);
    const auto link = PortLink::create(path_, port_);
    ASSERT_TRUE(link) << link.error().cause;
    EXPECT_EQ(fs::read_symlink(path_), port_);
}

TEST_F(PortLinkTest, ReplacesTheLinkOfAnInstanceWhosePortWeWereGiven) {
    fs::create_symlink(port_, path_);
    const auto link = PortLink::create(path_, port_);
    EXPECT_TRUE(link);
}

TEST_F(PortLinkTest, LeavesTheLinkOfAnotherInstanceAlone) {
    fs::create_symlink(other_port_, path_);
    {
        const auto link = PortLink::create(path_, port_);
        ASSERT_FALSE(link);
        EXPECT_EQ(link.error().code, errc::link_unavailable);
        EXPECT_THAT(link.error().cause, HasSubstr(path_ + ": is a link to " + other_port_));
    }
    EXPECT_EQ(fs::read_symlink(path_), other_port_);
}

TEST_F(PortLinkTest, LeavesFilesAndFoldersAlone) {
    const auto file = folder_.write("file", "precious");
    for (const auto& taken : {file, folder_.path("")}) {
        const auto link = PortLink::create(taken, port_);
        ASSERT_FALSE(link) << taken;
        EXPECT_EQ(link.error().code, errc::link_unavailable);
        EXPECT_FALSE(link.error().hint.empty());
    }
    EXPECT_EQ(fs::file_size(file), 8U);
}

TEST_F(PortLinkTest, SaysWhyALinkCannotBeMade) {
    const auto link = PortLink::create(folder_.path("no_folder/link"), port_);
    ASSERT_FALSE(link);
    EXPECT_THAT(link.error().cause, HasSubstr("No such file or directory"));
}

TEST_F(PortLinkTest, DoesNotRemoveALinkThatSomeoneElseHasPutThere) {
    {
        const auto link = PortLink::create(path_, port_);
        ASSERT_TRUE(link);
        fs::remove(path_);
        fs::create_symlink(other_port_, path_);
    }
    EXPECT_EQ(fs::read_symlink(path_), other_port_);
}

TEST_F(PortLinkTest, IsRemovedOnceWhenMoved) {
    auto link = PortLink::create(path_, port_);
    ASSERT_TRUE(link);
    {
        const PortLink moved = std::move(*link);
        EXPECT_TRUE(fs::is_symlink(path_));
    }
    EXPECT_FALSE(fs::is_symlink(path_));
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
