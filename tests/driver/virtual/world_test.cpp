// World: the built-in room, and worlds from files.
#include "driver/virtual/world.hpp"

#include "driver/virtual/error.hpp"
#include "tests/driver/virtual/scratch_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

namespace sweepcast::virtual_lidar {
namespace {

using testing::HasSubstr;

TEST(World, LivingRoomIsWithinReachOfAScannerAllRound) {
    const auto room = World::living_room();
    int without_echo = 0;
    for (int i = 0; i < 3600; ++i) {
        const auto distance_mm = room.distance_mm(i * 0.1, Seconds(0));
        without_echo += distance_mm ? 0 : 1;
        if (distance_mm) {
            EXPECT_GT(*distance_mm, 400.0) << i;
            EXPECT_LT(*distance_mm, 14'500.0) << i;
        }
    }
    EXPECT_GT(without_echo, 0) << "the corridor is open";
    EXPECT_LT(without_echo, 100);
}

TEST(World, LivingRoomHasItsWallsWhereTheyWereBuilt) {
    const auto room = World::living_room();
    EXPECT_NEAR(room.distance_mm(0.0, Seconds(0)).value_or(0), 3100.0, 1e-6);   // front
    EXPECT_NEAR(room.distance_mm(90.0, Seconds(0)).value_or(0), 2400.0, 1e-6);  // right
    EXPECT_NEAR(room.distance_mm(270.0, Seconds(0)).value_or(0), 850.0, 1e-6);  // the sofa, left
    EXPECT_NEAR(room.distance_mm(-90.0, Seconds(0)).value_or(0), 850.0, 1e-6);
}

TEST(World, LivingRoomHasSomethingThatMoves) {
    const auto room = World::living_room();
    int changed = 0;
    for (int i = 0; i < 360; ++i) {
        changed += room.distance_mm(i, Seconds(0)) != room.distance_mm(i, Seconds(3)) ? 1 : 0;
    }
    EXPECT_GE(changed, 10);
    EXPECT_LE(changed, 120) << "but the walls stand still";
}

TEST(World, PeopleStayInsideTheLivingRoomForEver) {
    const auto room = World::living_room();
    for (int second = 0; second < 120; ++second) {
        for (int i = 0; i < 360; ++i) {
            const auto distance_mm = room.distance_mm(i, Seconds(second + 1e6));
            EXPECT_GT(distance_mm.value_or(1e9), 400.0) << "at " << second << " s, " << i;
        }
    }
}

TEST(World, LoadsAFileOfPoints) {
    const ScratchFolder folder;
    const auto path = folder.write("room.csv", "angle_deg,distance_mm\n45,1234.5\n");
    const auto world = World::load(path);
    ASSERT_TRUE(world) << world.error().cause;
    EXPECT_EQ(world->distance_mm(45.0, Seconds(7)), 1234.5);
    EXPECT_EQ(world->distance_mm(50.0, Seconds(7)), std::nullopt);
}

TEST(World, NamesTheFileAndLineOfABadPoint) {
    const ScratchFolder folder;
    const auto path = folder.write("room.csv", "angle_deg,distance_mm\n45,far\n");
    const auto world = World::load(path);
    ASSERT_FALSE(world);
    EXPECT_EQ(world.error().code, errc::world_malformed);
    EXPECT_THAT(world.error().cause, HasSubstr(path + ", line 2: the distance \"far\""));
}

TEST(World, SaysThatAFileIsMissing) {
    const ScratchFolder folder;
    const auto world = World::load(folder.path("none.csv"));
    ASSERT_FALSE(world);
    EXPECT_EQ(world.error().code, errc::world_unreadable);
    EXPECT_THAT(world.error().cause, HasSubstr("none.csv: No such file or directory"));
}

TEST(World, DoesNotReadWhatMayNeverEnd) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo(folder.path("pipe").c_str(), 0600), 0);
    for (const auto& path : {folder.path("pipe"), folder.path(""), std::string("/dev/zero")}) {
        const auto world = World::load(path);
        ASSERT_FALSE(world) << path;
        EXPECT_THAT(world.error().cause, HasSubstr("not a regular file"));
    }
}

TEST(World, RefusesAFileThatIsTooLarge) {
    const ScratchFolder folder;
    const auto path = folder.write("big.csv", "angle_deg,distance_mm\n");
    std::filesystem::resize_file(path, 1ULL << 40U);  // sparse
    const auto world = World::load(path);
    ASSERT_FALSE(world);
    EXPECT_THAT(world.error().cause, HasSubstr("larger than 16 MiB"));
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
