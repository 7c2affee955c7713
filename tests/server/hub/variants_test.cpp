// Variants: who wants what, over all workers.
#include "server/hub/variants.hpp"

#include <gtest/gtest.h>

namespace sweepcast::hub {
namespace {

Wish nth(std::uint32_t n, std::optional<std::uint32_t> lidar = {}) {
    Wish wish{.lidar = lidar, .frames = {}};
    wish.frames.every_nth = n;
    return wish;
}

TEST(Variants, EqualWishesShareOne) {
    Variants variants;
    const auto first = variants.acquire(nth(2));
    EXPECT_EQ(variants.acquire(nth(2)), first);
    EXPECT_EQ(variants.acquire(nth(2, 7)), first);  // the lidar makes no other frame
    EXPECT_NE(variants.acquire(nth(3)), first);
    EXPECT_EQ(variants.subscribers(), 4U);
}

TEST(Variants, ALidarMakesWhatIsWantedOfItOrOfAll) {
    Variants variants;
    const auto of_all = variants.acquire(nth(2));
    const auto of_seven = variants.acquire(nth(3, 7));
    EXPECT_EQ(variants.wanted(1), std::vector<VariantPtr>{of_all});
    EXPECT_EQ(variants.wanted(7), (std::vector<VariantPtr>{of_all, of_seven}));
    variants.release(of_all, std::nullopt);
    EXPECT_TRUE(variants.wanted(1).empty());
    EXPECT_EQ(variants.wanted(7), std::vector<VariantPtr>{of_seven});
}

TEST(Variants, TheVersionTellsWhetherAnythingChanged) {
    Variants variants;
    auto before = variants.version();
    const auto first = variants.acquire(nth(2));
    EXPECT_NE(variants.version(), before);
    before = variants.version();
    (void)variants.acquire(nth(2));
    variants.release(first, std::nullopt);
    EXPECT_EQ(variants.version(), before);  // still wanted, of the same lidars
    (void)variants.acquire(nth(2, 1));
    EXPECT_NE(variants.version(), before);
    before = variants.version();
    variants.release(first, std::nullopt);
    EXPECT_NE(variants.version(), before);
}

TEST(Variants, AreLimitedInNumberNotInSubscribers) {
    Variants variants;
    std::vector<VariantPtr> taken;
    for (std::uint32_t i = 0; i < Variants::most; ++i) {
        taken.push_back(variants.acquire(nth(2 + i)));
        ASSERT_TRUE(taken.back());
    }
    EXPECT_FALSE(variants.acquire(nth(1000)));
    EXPECT_EQ(variants.acquire(nth(6)), taken[4]);
    EXPECT_TRUE(variants.acquire(nth(1000), taken[7]));   // which is about to be released
    EXPECT_FALSE(variants.acquire(nth(1001), taken[4]));  // somebody else has it too
    variants.release(taken[7], std::nullopt);
    EXPECT_FALSE(variants.acquire(nth(1001)));
    variants.release(taken[8], std::nullopt);
    EXPECT_TRUE(variants.acquire(nth(1001)));
}

/// The plain requests, each with the compressions that there are, and what the page asks for.
std::vector<Wish> plain_wishes() {
    std::vector<Wish> wishes;
    for (const auto kind : {frame::Kind::sweep, frame::Kind::sector}) {
        for (const auto compression : {frame::Compression::zstd, frame::Compression::none}) {
            Wish wish;
            wish.frames.kind = kind;
            wish.frames.format.compression = compression;
            wish.frames.sector_mdeg = kind == frame::Kind::sector ? frame::usual_sector_mdeg : 0;
            wishes.push_back(wish);
        }
        auto& packed = wishes.emplace_back(wishes[wishes.size() - 2]);
        packed.frames.format.dictionary = true;
    }
    Wish page;
    page.frames.kind = frame::Kind::sector;
    page.frames.sector_mdeg = frame::usual_sector_mdeg;
    page.frames.format.leave_out_flags = true;
    page.frames.format.leave_out_times = true;
    wishes.push_back(page);
    return wishes;
}

TEST(Variants, PlainRequestsAreServedHoweverManyOthersThereAre) {
    Variants variants;
    for (std::uint32_t i = 0; i < Variants::most; ++i) {
        ASSERT_TRUE(variants.acquire(nth(2 + i)));
    }
    for (const auto& plain : plain_wishes()) {
        EXPECT_TRUE(variants.acquire(plain));
    }
    EXPECT_FALSE(variants.acquire(nth(1000)));
}

TEST(Variants, PlainRequestsTakeNoPlaceOfOthers) {
    Variants variants;
    for (const auto& plain : plain_wishes()) {
        ASSERT_TRUE(variants.acquire(plain));
    }
    for (std::uint32_t i = 0; i < Variants::most; ++i) {
        EXPECT_TRUE(variants.acquire(nth(2 + i)));
    }
}

TEST(Variants, AChangeFromAPlainRequestMakesNoRoomForAnother) {
    Variants variants;
    const auto plain = variants.acquire(Wish{});
    for (std::uint32_t i = 0; i < Variants::most; ++i) {
        ASSERT_TRUE(variants.acquire(nth(2 + i)));
    }
    EXPECT_FALSE(variants.acquire(nth(1000), plain));
}

}  // namespace
}  // namespace sweepcast::hub
