// What users ask for by options becomes a Subscribe.
#include "server/cli/wish_options.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <gtest/gtest.h>

namespace sweepcast::cli {
namespace {

struct Command {
    Command() { add_wish_options(app, wish); }
    CLI::App app;
    v1::Subscribe wish;
};

TEST(WishOptionsTest, EachSetsItsField) {
    Command command;
    command.app.parse(
        "--lidar left --compression none --kind sector --sector-deg 22.5 --max-latency 10 "
        "--max-rate 2.5 --keep 90-270 --keep 350-10.5 --mask 0-1 --min-distance 100 "
        "--max-distance 4000 --min-quality 10 --every 3 --bins 360 --bins-minimum"
    );
    const auto& wish = command.wish;
    EXPECT_EQ(wish.lidar(), "left");
    EXPECT_EQ(wish.compression(), v1::NONE);
    EXPECT_EQ(wish.kind(), v1::SECTOR);
    EXPECT_EQ(wish.sector_deg(), 22.5);
    EXPECT_EQ(wish.max_latency_ms(), 10);
    EXPECT_EQ(wish.max_rate_hz(), 2.5);
    ASSERT_EQ(wish.keep_size(), 2);
    EXPECT_EQ(wish.keep(0).from_deg(), 90);
    EXPECT_EQ(wish.keep(1).from_deg(), 350);
    EXPECT_EQ(wish.keep(1).to_deg(), 10.5);
    ASSERT_EQ(wish.mask_size(), 1);
    EXPECT_EQ(wish.mask(0).to_deg(), 1);
    EXPECT_EQ(wish.min_distance_mm(), 100);
    EXPECT_EQ(wish.max_distance_mm(), 4000);
    EXPECT_EQ(wish.min_quality(), 10U);
    EXPECT_EQ(wish.every_nth(), 3U);
    EXPECT_EQ(wish.bins().count(), 360U);
    EXPECT_EQ(wish.bins().pick(), v1::Bins::MINIMUM);
    EXPECT_EQ(given_wish_option(command.app), "--lidar");
}

TEST(WishOptionsTest, NoneIsTheEmptyWish) {
    Command command;
    command.app.parse("");
    EXPECT_EQ(command.wish.ByteSizeLong(), 0U);
    EXPECT_EQ(given_wish_option(command.app), std::nullopt);
}

TEST(WishOptionsTest, WhatIsNoWishIsRefused) {
    for (const auto* line :
         {"--kind scan",
          "--keep 10",
          "--keep 10-",
          "--keep -10-20",
          "--mask 10-361",
          "--mask 10-nan",
          "--min-quality 256",
          "--max-rate -1",
          "--bins 0",
          "--bins-minimum"}) {
        Command command;
        EXPECT_THROW(command.app.parse(line), CLI::ParseError) << line;
    }
}

}  // namespace
}  // namespace sweepcast::cli
