// BadLine: what arrives of bytes.
#include "driver/virtual/bad_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace sweepcast::virtual_lidar {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes arrived(BadLine& line, const Bytes& sent) {
    Bytes bytes;
    for (const auto byte : sent) {
        line.pass(byte, bytes);
    }
    return bytes;
}

Bytes counting(std::size_t size) {
    Bytes bytes(size);
    for (std::size_t i = 0; i < size; ++i) {
        bytes[i] = static_cast<std::uint8_t>(i);
    }
    return bytes;
}

TEST(BadLine, DoesTheSameDamageForTheSameSeed) {
    const auto damaged = [](std::uint64_t seed) {
        BadLine line({.noise = 0.1, .drop = 0.1, .duplicate = 0.1}, seed);
        return arrived(line, counting(1000));
    };
    EXPECT_EQ(damaged(1), damaged(1));
    EXPECT_NE(damaged(1), damaged(2));
}

TEST(BadLine, DoublesThatPartOfTheBytes) {
    BadLine line({.duplicate = 0.1}, 1);
    EXPECT_NEAR(static_cast<double>(arrived(line, Bytes(10'000, 7)).size()), 11'000.0, 150.0);
    BadLine each({.duplicate = 1.0}, 1);
    EXPECT_EQ(arrived(each, {1, 2}), (Bytes{1, 1, 2, 2}));
}

TEST(BadLine, LosesTheNextBytesWhenToldTo) {
    BadLine line({}, 1);
    EXPECT_TRUE(line.is_good());
    line.lose_next(3);
    EXPECT_FALSE(line.is_good());
    EXPECT_EQ(arrived(line, {1, 2, 3, 4, 5}), (Bytes{4, 5}));
    EXPECT_TRUE(line.is_good());
}

TEST(BadLine, IsGoodAgainWhenItsQualityIs) {
    BadLine line({.noise = 1.0}, 1);
    const auto sent = counting(500);
    const auto bytes = arrived(line, sent);
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), sent.begin(), [](auto got, auto was) {
        return got != was;
    }));
    line.set_quality({});
    EXPECT_EQ(arrived(line, sent), sent);
}

}  // namespace
}  // namespace sweepcast::virtual_lidar
