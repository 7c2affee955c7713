// Which ports are looked at, and which are left alone.
#include "driver/link/discovery.hpp"

#include "tests/driver/link/pty_pair.hpp"
#include "tests/driver/link/scratch_directory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::link {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

FoundPort device(const std::string& path) {
    return {path, path, true, ""};
}

FoundPort usb(const std::string& path, bool lidar_adapter) {
    auto port = device(path);
    port.adapter = lidar_adapter ? "CP2102 (10c4:ea60)" : "FT232R (0403:6001)";
    port.lidar_adapter = lidar_adapter;
    return port;
}

TEST(DiscoveryPlanTest, LooksBehindTheAdaptersThatLidarsAreSoldWithAlone) {
    PortsThere there;
    there.usb = {usb("/dev/ttyUSB0", true), usb("/dev/ttyUSB1", false), usb("/dev/ttyUSB2", true)};
    const auto plan = plan_discovery(there);
    EXPECT_THAT(plan.look_at, ElementsAre("/dev/ttyUSB0", "/dev/ttyUSB2"));
    ASSERT_EQ(plan.skipped.size(), 1U);
    EXPECT_EQ(plan.skipped[0].path, "/dev/ttyUSB1");
    EXPECT_THAT(plan.skipped[0].why, HasSubstr("FT232R (0403:6001)"));
    EXPECT_THAT(plan.skipped[0].why, HasSubstr("--discover /dev/ttyUSB1"));
}

TEST(DiscoveryPlanTest, LooksAtWhatThePatternsOfTheUserMatchToo) {
    PortsThere there;
    there.usb = {usb("/dev/ttyUSB0", true), usb("/dev/ttyUSB1", false)};
    there.patterns = {
        {"/dev/ttyAMA*", {device("/dev/ttyAMA0"), device("/dev/ttyAMA1")}},
        {"/dev/ttyUSB1", {device("/dev/ttyUSB1")}}};
    const auto plan = plan_discovery(there);
    EXPECT_THAT(
        plan.look_at,
        ElementsAre("/dev/ttyUSB0", "/dev/ttyAMA0", "/dev/ttyAMA1", "/dev/ttyUSB1")
    );
    EXPECT_THAT(plan.skipped, IsEmpty());
}

TEST(DiscoveryPlanTest, LooksAtADeviceOnceWhateverItsNames) {
    PortsThere there;
    there.usb = {usb("/dev/ttyUSB0", true)};
    auto link = device("/tmp/lidar");
    link.node = "/dev/pts/5";
    there.patterns = {
        {"/dev/ttyUSB*", {device("/dev/ttyUSB0")}},
        {"/tmp/lidar", {link}},
        {"/dev/pts/5", {device("/dev/pts/5")}}};
    EXPECT_THAT(plan_discovery(there).look_at, ElementsAre("/dev/ttyUSB0", "/tmp/lidar"));
}

TEST(DiscoveryPlanTest, LeavesWhatTheUserNamedToItself) {
    PortsThere there;
    there.usb = {usb("/dev/ttyUSB0", true), usb("/dev/ttyUSB1", false)};
    there.patterns = {{"/dev/ttyAMA0", {device("/dev/ttyAMA0")}}};
    there.taken_nodes = {"/dev/ttyUSB0", "/dev/ttyUSB1", "/dev/ttyAMA0"};
    const auto plan = plan_discovery(there);
    EXPECT_THAT(plan.look_at, IsEmpty());
    EXPECT_THAT(
        plan.skipped,
        ElementsAre(
            DiscoveryPlan::Skipped{"/dev/ttyUSB0", "named by --lidar already"},
            DiscoveryPlan::Skipped{"/dev/ttyAMA0", "named by --lidar already"}
        )
    );
}

TEST(DiscoveryPlanTest, LeavesAPortToTheProcessThatHasItOpen) {
    PortsThere there;
    there.usb = {usb("/dev/ttyUSB0", true)};
    there.usb[0].holder = "minicom (process 812)";
    there.patterns = {{"/dev/ttyUSB*", there.usb}};
    const auto plan = plan_discovery(there);
    EXPECT_THAT(plan.look_at, IsEmpty());
    EXPECT_THAT(
        plan.skipped,
        ElementsAre(DiscoveryPlan::Skipped{"/dev/ttyUSB0", "in use by minicom (process 812)"})
    ) << "said once";
}

TEST(DiscoveryPlanTest, SaysThatAPatternMatchesNothingOrNoDevice) {
    PortsThere there;
    auto file = device("/tmp/notes");
    file.is_device = false;
    there.patterns = {{"/dev/ttyXY*", {}}, {"/tmp/notes", {file}}};
    const auto plan = plan_discovery(there);
    EXPECT_THAT(plan.look_at, IsEmpty());
    EXPECT_THAT(
        plan.skipped,
        ElementsAre(
            DiscoveryPlan::Skipped{"/dev/ttyXY*", "matches nothing"},
            DiscoveryPlan::Skipped{"/tmp/notes", "not a device"}
        )
    );
}

TEST(DiscoveryPlanTest, IsBounded) {
    PortsThere there;
    PatternMatches many{"/dev/tty*", {}};
    for (std::size_t i = 0; i < most_ports + 3; ++i) {
        many.ports.push_back(device("/dev/tty" + std::to_string(i)));
    }
    there.patterns = {many};
    const auto plan = plan_discovery(there);
    EXPECT_EQ(plan.look_at.size(), most_ports);
    EXPECT_EQ(plan.skipped.size(), 3U);
}

class LookAroundTest : public testing::Test {
protected:
    /// Nothing of this machine: no USB port, nobody who has a port open.
    PortsThere look(const std::vector<std::string>& patterns, const std::vector<LinkUrl>& taken) {
        const SystemRoots nothing{scratch_.root() / "sys", scratch_.root() / "dev"};
        return look_around(patterns, taken, nothing, scratch_.root() / "proc");
    }

    ScratchDirectory scratch_;
};

TEST_F(LookAroundTest, ResolvesLinksOfMatches) {
    const PtyPair pty;
    scratch_.link("lidar-left", pty.path());
    scratch_.file("lidar-notes", "hello");
    const auto root = scratch_.root().string();
    const auto there = look({root + "/lidar-*", root + "/none*"}, {});
    ASSERT_EQ(there.patterns.size(), 2U);
    EXPECT_THAT(
        there.patterns[0].ports,
        ElementsAre(
            FoundPort{root + "/lidar-left", pty.path(), true, ""},
            FoundPort{root + "/lidar-notes", root + "/lidar-notes", false, ""}
        )
    );
    EXPECT_THAT(there.patterns[1].ports, IsEmpty());
}

TEST_F(LookAroundTest, ResolvesLinksOfWhatTheUserNamed) {
    const PtyPair pty;
    scratch_.link("lidar", pty.path());
    const auto path = (scratch_.root() / "lidar").string();
    const auto there = look({pty.path()}, {*parse_link_url(path)});
    EXPECT_THAT(there.taken_nodes, ElementsAre(pty.path()));
    EXPECT_THAT(plan_discovery(there).look_at, IsEmpty());
}

TEST_F(LookAroundTest, TellsWhoHasAPortOpen) {
    const PtyPair pty;
    scratch_.link("proc/812/fd/3", pty.path());
    scratch_.file("proc/812/comm", "minicom\n");
    const auto there = look({pty.path()}, {});
    EXPECT_EQ(there.patterns.at(0).ports.at(0).holder, "minicom (process 812)");
}

TEST_F(LookAroundTest, TellsWhoHasAPortOpenUnderEachOfItsNames) {
    const PtyPair pty;
    scratch_.link("lidar", pty.path());
    scratch_.link("proc/812/fd/3", pty.path());
    scratch_.file("proc/812/comm", "minicom\n");
    const auto link = (scratch_.root() / "lidar").string();
    const auto there = look({link, pty.path()}, {});
    EXPECT_EQ(
        there.patterns.at(0).ports.at(0),
        (FoundPort{link, pty.path(), true, "minicom (process 812)"})
    );
    EXPECT_EQ(there.patterns.at(1).ports.at(0).holder, "minicom (process 812)");
}

TEST_F(LookAroundTest, FindsEachDeviceWorthALookOnce) {
    const PtyPair pty;
    scratch_.link("lidar-left", pty.path());
    scratch_.file("lidar-notes", "hello");
    scratch_.link("lidar-old", scratch_.root() / "gone");
    const SystemRoots nothing{scratch_.root() / "sys", scratch_.root() / "dev"};
    const auto left = (scratch_.root() / "lidar-left").string();
    EXPECT_THAT(
        ports_worth_a_look({(scratch_.root() / "lidar-*").string(), pty.path()}, nothing),
        ElementsAre(left)
    );
}

TEST_F(LookAroundTest, FindsNoMoreDevicesWorthALookThanItsBound) {
    std::vector<PtyPair> ptys(most_ports + 3);
    for (std::size_t i = 0; i < ptys.size(); ++i) {
        scratch_.link("lidar-" + std::to_string(i), ptys[i].path());
    }
    const SystemRoots nothing{scratch_.root() / "sys", scratch_.root() / "dev"};
    const auto found = ports_worth_a_look({(scratch_.root() / "lidar-*").string()}, nothing);
    EXPECT_EQ(found.size(), most_ports);
}

TEST(PlaceKey, IsTheSameForAllNamesOfAPlace) {
    const ScratchDirectory scratch;
    const auto file = scratch.file("port", "").string();
    scratch.link("link", file);
    const auto link = (scratch.root() / "link").string();
    EXPECT_EQ(place_key(*parse_link_url(link)), place_key(*parse_link_url("serial:" + file)));
    EXPECT_EQ(
        place_key(*parse_link_url("tcp://robot")),
        place_key(*parse_link_url("tcp://robot:20108/"))
    );
    EXPECT_NE(
        place_key(*parse_link_url("tcp://robot:1")),
        place_key(*parse_link_url("udp://robot:1"))
    );
}

}  // namespace
}  // namespace sweepcast::link
