// AngleSet: windows of the circle, and sets made of them.
#include "server/frame/angle_set.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace sweepcast::frame {
namespace {

using protocol::AngleQ14;
using Windows = std::vector<AngleWindow>;

/// The angle so many units of 1/65536 turn after `degrees`.
AngleQ14 at(double degrees, int more = 0) {
    return {static_cast<std::uint16_t>(degrees * 65536 / 360 + more)};
}

TEST(AngleSet, HoldsItsFirstAngleAndNotItsLast) {
    const AngleSet set(Windows{{90, 180}}, {});
    EXPECT_FALSE(set.contains(at(90, -1)));
    EXPECT_TRUE(set.contains(at(90)));
    EXPECT_TRUE(set.contains(at(180, -1)));
    EXPECT_FALSE(set.contains(at(180)));
}

TEST(AngleSet, AWindowMayGoOverZero) {
    const AngleSet set(Windows{{315, 45}}, {});
    EXPECT_TRUE(set.contains(at(315)));
    EXPECT_TRUE(set.contains({0}));
    EXPECT_FALSE(set.contains(at(45)));
    EXPECT_FALSE(set.contains(at(180)));
    EXPECT_TRUE(AngleSet(Windows{{350, 0}}, {}).contains({65535}));
    EXPECT_FALSE(AngleSet(Windows{{350, 0}}, {}).contains({0}));
    EXPECT_TRUE(AngleSet(Windows{{360, 10}}, {}).contains({0}));
}

TEST(AngleSet, IsTheWholeCircleWithoutWindows) {
    EXPECT_TRUE(AngleSet().is_whole_circle());
    EXPECT_TRUE(AngleSet({}, {}).is_whole_circle());
    EXPECT_TRUE(AngleSet(Windows{{0, 360}}, {}).is_whole_circle());
    EXPECT_TRUE(AngleSet(Windows{{0, 200}, {200, 0}}, {}).is_whole_circle());
    EXPECT_FALSE(AngleSet({}, Windows{{0, 1}}).is_whole_circle());
}

TEST(AngleSet, IsEmptyIfEverythingIsMasked) {
    EXPECT_TRUE(AngleSet({}, Windows{{0, 360}}).is_empty());
    EXPECT_TRUE(AngleSet(Windows{{10, 20}}, Windows{{5, 30}}).is_empty());
    EXPECT_FALSE(AngleSet(Windows{{10, 20}}, Windows{{5, 15}}).is_empty());
}

TEST(AngleSet, IsEqualHoweverItWasMade) {
    const AngleSet set(Windows{{10, 20}, {20, 30}, {350, 5}}, {});
    EXPECT_EQ(set, AngleSet(Windows{{350, 40}}, Windows{{5, 10}, {30, 40}}));
    EXPECT_NE(set, AngleSet(Windows{{350, 40}}, {}));
}

Windows random_windows(std::mt19937_64& random) {
    Windows windows(random() % 4);
    for (auto& window : windows) {
        window.from_deg = static_cast<double>(random() % 36'001) / 100;
        window.to_deg = static_cast<double>(random() % 36'001) / 100;
    }
    return windows;
}

/// As the schema says it.
bool is_in(const AngleWindow& window, AngleQ14 angle) {
    const double degrees = angle.degrees();
    return window.from_deg <= window.to_deg ? degrees >= window.from_deg && degrees < window.to_deg
                                            : degrees >= window.from_deg || degrees < window.to_deg;
}

bool in_any(const Windows& windows, AngleQ14 angle) {
    return std::any_of(windows.begin(), windows.end(), [angle](const AngleWindow& window) {
        return is_in(window, angle);
    });
}

TEST(AngleSet, AgreesWithItsWindowsAtEveryAngle) {
    std::mt19937_64 random(5);  // NOLINT(cert-msc51-cpp): the same windows in every run
    for (int i = 0; i < 40; ++i) {
        const auto keep = random_windows(random);
        const auto mask = random_windows(random);
        const AngleSet set(keep, mask);
        EXPECT_EQ(set.is_empty(), set.windows().empty());
        if (!set.is_empty()) {
            EXPECT_EQ(AngleSet(set.windows(), {}), set);
        }
        for (std::uint32_t angle = 0; angle < 65536; ++angle) {
            const AngleQ14 q14{static_cast<std::uint16_t>(angle)};
            const bool expected = (keep.empty() || in_any(keep, q14)) && !in_any(mask, q14);
            ASSERT_EQ(set.contains(q14), expected) << angle << " in case " << i;
        }
    }
}

}  // namespace
}  // namespace sweepcast::frame
