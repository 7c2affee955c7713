// Wishes as clients write them: what is understood, and what is refused.
#include "server/stream/subscribe_wish.hpp"

#include "server/frame/dictionary.hpp"
#include "server/hub/variants.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <string>

namespace sweepcast::stream {
namespace {

using namespace std::chrono_literals;

/// "kind=sector&keep=1-2" as a server has it.
Query query(const std::string& text) {
    Query query;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find('&', at), text.size());
        const auto equals = text.find('=', at);
        query.emplace_back(text.substr(at, equals - at), text.substr(equals + 1, end - equals - 1));
        at = end + 1;
    }
    return query;
}

Result<frame::Wish, Refusal> wish_in(const std::string& text) {
    auto subscribe = subscribe_from_query(query(text));
    return subscribe ? frame_wish(*subscribe) : Result<frame::Wish, Refusal>(subscribe.error());
}

TEST(SubscribeWish, EveryWishCanStandInAUrl) {
    const auto wish = wish_in(
        "kind=sweep&compression=none&max_rate_hz=4&keep=350-10&keep=90-180.5,200-210&mask=100-110"
        "&min_distance_mm=100.1&max_distance_mm=8000.9&min_quality=20&every_nth=3"
        "&leave_out=quality,flag&leave_out=time&distance_unit_um=2000&angle_units_per_turn=3600"
    );
    ASSERT_TRUE(wish) << wish.error().message;
    EXPECT_EQ(wish->kind, frame::Kind::sweep);
    EXPECT_EQ(wish->format.compression, frame::Compression::none);
    EXPECT_EQ(wish->least_interval, 250ms);
    const std::vector<frame::AngleWindow> keep{{350, 10}, {90, 180.5}, {200, 210}};
    const std::vector<frame::AngleWindow> mask{{100, 110}};
    EXPECT_EQ(wish->angles, frame::AngleSet(keep, mask));
    EXPECT_EQ(wish->nearest.raw, 401U);
    EXPECT_EQ(wish->farthest.raw, 32003U);
    EXPECT_EQ(wish->min_quality, 20);
    EXPECT_EQ(wish->every_nth, 3U);
    EXPECT_TRUE(wish->format.leave_out_quality);
    EXPECT_TRUE(wish->format.leave_out_flags);
    EXPECT_TRUE(wish->format.leave_out_times);
    EXPECT_EQ(wish->format.distance_unit_um, 2000U);
    EXPECT_EQ(wish->format.angle_units_per_turn, 3600U);
}

TEST(SubscribeWish, BinsBringTheirOwnUnitsOfAngle) {
    const auto wish = wish_in("bins=720&bins_pick=minimum");
    ASSERT_TRUE(wish);
    EXPECT_EQ(wish->bins, (frame::Bins{720, frame::BinPick::minimum}));
    EXPECT_EQ(wish->format.angle_units_per_turn, 1440U);
}

TEST(SubscribeWish, SectorsHaveAUsualSize) {
    auto subscribe = *subscribe_from_query(query("kind=sector"));
    const auto wish = frame_wish(subscribe);
    ASSERT_TRUE(wish);
    EXPECT_EQ(wish->sector_mdeg, 30'000U);
    EXPECT_EQ(wish->max_latency, 0us);
    EXPECT_EQ(subscribe.sector_deg(), 30);  // as it is echoed
    EXPECT_EQ(wish_in("kind=sector&max_latency_ms=12.5")->max_latency, 12'500us);
    EXPECT_EQ(wish_in("kind=sector&max_latency_ms=12.5")->sector_mdeg, 0U);
    EXPECT_EQ(wish_in("kind=sector&sector_deg=0.0001")->sector_mdeg, 1U);
    EXPECT_EQ(wish_in("kind=sector&max_latency_ms=0.0000001")->max_latency, 1us);
}

TEST(SubscribeWish, OurDictionaryIsUsedIfTheClientHasIt) {
    const auto ours = std::to_string(frame::dictionary_id());
    EXPECT_TRUE(wish_in("dictionaries=1,2," + ours)->format.dictionary);
    EXPECT_FALSE(wish_in("dictionaries=1,2")->format.dictionary);
    EXPECT_FALSE(wish_in("compression=none&dictionaries=" + ours)->format.dictionary);
    auto subscribe = *subscribe_from_query(query("dictionaries=1,2," + ours));
    ASSERT_TRUE(frame_wish(subscribe));
    ASSERT_EQ(subscribe.dictionaries_size(), 1);
    EXPECT_EQ(subscribe.dictionaries(0), frame::dictionary_id());
}

TEST(SubscribeWish, WishesForTheSameAreEqual) {
    EXPECT_EQ(wish_in("")->angles, wish_in("keep=0-360")->angles);
    EXPECT_EQ(*wish_in(""), *wish_in("every_nth=1&max_rate_hz=0&min_quality=0&dictionaries=5"));
    EXPECT_EQ(*wish_in("keep=0-10&keep=10-20"), *wish_in("keep=0-90&mask=20-90"));
}

TEST(SubscribeWish, WhatThePageAndPlainClientsAskForIsPlain) {
    const auto ours = std::to_string(frame::dictionary_id());
    for (const auto& text : {
             std::string("kind=sector&compression=zstd&sector_deg=30&leave_out=flag,time"
             ),  // the page
             std::string(),
             std::string("kind=sweep"),
             std::string("kind=sector"),
             std::string("compression=none"),
             "dictionaries=" + ours,
             "kind=sector&sector_deg=30&dictionaries=" + ours,
         }) {
        EXPECT_TRUE(hub::Variants::is_plain(*wish_in(text))) << text;
    }
    for (const std::string text :
         {"bins=360",
          "every_nth=2",
          "kind=sector&sector_deg=29",
          "leave_out=quality",
          "max_rate_hz=2"}) {
        EXPECT_FALSE(hub::Variants::is_plain(*wish_in(text))) << text;
    }
}

struct Refused {
    std::string query, code;
};

class RefusedWishTest : public testing::TestWithParam<Refused> {};

TEST_P(RefusedWishTest, SaysWhatIsWrongAndWhatToDo) {
    const auto wish = wish_in(GetParam().query);
    ASSERT_FALSE(wish);
    EXPECT_EQ(wish.error().code, GetParam().code);
    EXPECT_NE(wish.error().message, "");
    EXPECT_NE(wish.error().hint, "");
}

INSTANTIATE_TEST_SUITE_P(
    Queries,
    RefusedWishTest,
    testing::Values(
        Refused{"kind=turn", "unknown_kind"},
        Refused{"compression=gzip", "unknown_compression"},
        Refused{"compresion=none", "unknown_parameter"},
        Refused{"leave_out=quality,angle", "unknown_column"},
        Refused{"kind=sweep&kind=sector", "repeated_parameter"},
        Refused{"bins=", "bad_value"},
        Refused{"bins=-1", "bad_value"},
        Refused{"bins=7.5", "bad_value"},
        Refused{"bins=99999999999", "bad_value"},
        Refused{"max_rate_hz=5x", "bad_value"},
        Refused{"max_rate_hz=1e3", "bad_value"},
        Refused{"max_rate_hz= 5", "bad_value"},
        Refused{"keep=10", "bad_value"},
        Refused{"keep=10-", "bad_value"},
        Refused{"keep=10-20,", "bad_value"},
        Refused{"dictionaries=a", "bad_value"},
        Refused{"bins_pick=median", "bad_value"},
        Refused{"bins_pick=minimum", "out_of_range"},
        Refused{"bins=0", "out_of_range"},
        Refused{"bins=16385", "out_of_range"},
        Refused{"max_rate_hz=nan", "out_of_range"},
        Refused{"max_rate_hz=inf", "out_of_range"},
        Refused{"max_rate_hz=-1", "out_of_range"},
        Refused{"max_rate_hz=1001", "out_of_range"},
        Refused{"max_rate_hz=0.0001", "out_of_range"},
        Refused{"kind=sector&sector_deg=nan", "out_of_range"},
        Refused{"kind=sector&sector_deg=360.1", "out_of_range"},
        Refused{"kind=sector&sector_deg=-30", "out_of_range"},
        Refused{"kind=sector&max_latency_ms=-1", "out_of_range"},
        Refused{"kind=sector&max_latency_ms=60001", "out_of_range"},
        Refused{"keep=0-361", "out_of_range"},
        Refused{"keep=nan-10", "out_of_range"},
        Refused{"mask=0-inf", "out_of_range"},
        Refused{"keep=10-10", "empty_window"},
        Refused{"mask=360-0", "empty_window"},
        Refused{"mask=0-360", "nothing_left"},
        Refused{"keep=10-20&mask=0-90", "nothing_left"},
        Refused{"min_distance_mm=nan", "out_of_range"},
        Refused{"max_distance_mm=1000001", "out_of_range"},
        Refused{"min_quality=256", "out_of_range"},
        Refused{"every_nth=16385", "out_of_range"},
        Refused{"distance_unit_um=1000001", "out_of_range"},
        Refused{"angle_units_per_turn=359", "out_of_range"},
        Refused{"angle_units_per_turn=65537", "out_of_range"},
        Refused{"sector_deg=30", "contradiction"},
        Refused{"max_latency_ms=30", "contradiction"},
        Refused{"kind=sector&bins=10", "contradiction"},
        Refused{"kind=sector&max_rate_hz=5", "contradiction"},
        Refused{"bins=10&angle_units_per_turn=720", "contradiction"},
        Refused{"min_distance_mm=2&max_distance_mm=1", "contradiction"}
    )
);

TEST(SubscribeWish, ListsHaveLimits) {
    v1::Subscribe windows;
    for (int i = 0; i < 17; ++i) {
        auto& window = *windows.add_mask();
        window.set_from_deg(i);
        window.set_to_deg(i + 1);
    }
    EXPECT_EQ(frame_wish(windows).error().code, "too_many_windows");
    windows.mutable_mask()->RemoveLast();
    EXPECT_TRUE(frame_wish(windows));
    v1::Subscribe dictionaries;
    for (std::uint32_t i = 0; i < 65; ++i) {
        dictionaries.add_dictionaries(i);
    }
    EXPECT_EQ(frame_wish(dictionaries).error().code, "too_many_dictionaries");
}

TEST(SubscribeWish, WhatALaterVersionMayAskForIsRefused) {
    v1::Subscribe kind;
    kind.set_kind(static_cast<v1::Kind>(99));
    EXPECT_EQ(frame_wish(kind).error().code, "unknown_kind");
    v1::Subscribe compression;
    compression.set_compression(static_cast<v1::Compression>(99));
    EXPECT_EQ(frame_wish(compression).error().code, "unknown_compression");
    v1::Subscribe column;
    column.add_leave_out(v1::COLUMN_UNKNOWN);
    EXPECT_EQ(frame_wish(column).error().code, "unknown_column");
    v1::Subscribe pick;
    pick.mutable_bins()->set_count(5);
    pick.mutable_bins()->set_pick(static_cast<v1::Bins::Pick>(7));
    EXPECT_EQ(frame_wish(pick).error().code, "out_of_range");
}

TEST(SubscribeWish, NoNumberWhateverItIsMakesAWishThatIsOutOfRange) {
    constexpr double most = std::numeric_limits<double>::max();
    constexpr double least = std::numeric_limits<double>::denorm_min();
    for (const double value : {most, -most, least, -least, 1e-300, 1e300, 0.0, -0.0}) {
        v1::Subscribe sectors;
        sectors.set_kind(v1::SECTOR);
        sectors.set_sector_deg(value);
        sectors.set_max_latency_ms(value);
        const auto wish = frame_wish(sectors);
        if (wish) {
            EXPECT_TRUE(wish->sector_mdeg > 0 || wish->max_latency.count() > 0) << value;
            EXPECT_LE(wish->sector_mdeg, 360'000U);
        }
        v1::Subscribe rate;
        rate.set_max_rate_hz(value);
        rate.set_min_distance_mm(value);
        rate.set_max_distance_mm(value);
        if (const auto limited = frame_wish(rate)) {
            EXPECT_GE(limited->least_interval.count(), 0) << value;
        }
    }
}

}  // namespace
}  // namespace sweepcast::stream
