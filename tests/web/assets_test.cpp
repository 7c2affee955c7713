// The page's files as they are built into the program.
#include "web/assets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <set>
#include <string_view>

namespace sweepcast::web {
namespace {

const Asset* find(std::string_view path) {
    const auto all = assets();
    const auto found = std::find_if(all.begin(), all.end(), [&](const Asset& asset) {
        return asset.path == path;
    });
    return found == all.end() ? nullptr : &*found;
}

struct Expected {
    std::string_view path;
    std::string_view content_type;
};

void PrintTo(const Expected& expected, std::ostream* out) {
    *out << expected.path;
}

class AssetTest : public testing::TestWithParam<Expected> {};

TEST_P(AssetTest, IsThereWithItsType) {
    const Asset* asset = find(GetParam().path);
    ASSERT_NE(asset, nullptr);
    EXPECT_EQ(asset->content_type, GetParam().content_type);
}

TEST_P(AssetTest, IsOneGzipMember) {
    const Asset* asset = find(GetParam().path);
    ASSERT_NE(asset, nullptr);
    // RFC 1952: magic, deflate, and at least a header and a trailer.
    ASSERT_GT(asset->gzip.size(), 18U);
    EXPECT_EQ(asset->gzip[0], 0x1f);
    EXPECT_EQ(asset->gzip[1], 0x8b);
    EXPECT_EQ(asset->gzip[2], 8);
}

INSTANTIATE_TEST_SUITE_P(
    Page,
    AssetTest,
    testing::Values(
        Expected{"/index.html", "text/html; charset=utf-8"},
        Expected{"/app.js", "text/javascript; charset=utf-8"},
        Expected{"/app.css", "text/css; charset=utf-8"},
        Expected{"/favicon.svg", "image/svg+xml"}
    )
);

TEST(AssetsTest, HaveAnEntityTagEachInQuotes) {
    std::set<std::string_view> tags;
    for (const Asset& asset : assets()) {
        EXPECT_GT(asset.etag.size(), 2U);
        EXPECT_EQ(asset.etag.front(), '"');
        EXPECT_EQ(asset.etag.back(), '"');
        tags.insert(asset.etag);
    }
    EXPECT_EQ(tags.size(), assets().size());
}

}  // namespace
}  // namespace sweepcast::web
