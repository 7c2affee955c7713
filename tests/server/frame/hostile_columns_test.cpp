// Scans that lie: each lie is refused by its name.
#include "server/frame/error.hpp"
#include "server/frame/scan_columns.hpp"
#include "sweepcast/v1/scan.pb.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

namespace sweepcast::frame {
namespace {

/// An honest scan of three samples, to be spoilt.
v1::Scan honest_scan() {
    v1::Scan scan;
    scan.set_angle_units_per_turn(23040);
    scan.set_distance_unit_um(1000);
    for (int i = 0; i < 3; ++i) {
        scan.add_angle(10);
        scan.add_distance(3);
    }
    scan.set_echo_quality(188);
    scan.set_flag(2);
    scan.add_flag_index(0);
    scan.set_flag_value("\x01");
    scan.set_sample_period_ns(500'000);
    scan.add_time_step_ps(500'000'000);
    scan.add_time_run(3);
    scan.set_answer_type(0x82);
    return scan;
}

TEST(HostileColumns, AreMadeFromAScanThatIsFine) {
    const auto decoded = from_columns(honest_scan());
    ASSERT_TRUE(decoded.has_value());
    EXPECT_EQ(decoded->sweep.samples.size(), 3U);
    EXPECT_EQ(decoded->sweep.samples[2].distance.millimetres(), 3.0);
}

struct Lie {
    std::string name;
    std::function<void(v1::Scan&)> tell;
    errc expected;
};

class HostileColumnsTest : public testing::TestWithParam<Lie> {};

TEST_P(HostileColumnsTest, AreRefused) {
    auto scan = honest_scan();
    GetParam().tell(scan);
    EXPECT_EQ(from_columns(scan).error(), GetParam().expected);
}

constexpr auto largest32 = std::numeric_limits<std::int32_t>::max();
constexpr auto smallest32 = std::numeric_limits<std::int32_t>::min();

INSTANTIATE_TEST_SUITE_P(
    Lengths,
    HostileColumnsTest,
    testing::Values(
        Lie{"no_angles", [](auto& s) { s.clear_angle(); }, errc::column_length_wrong},
        Lie{"an_angle_more", [](auto& s) { s.add_angle(0); }, errc::column_length_wrong},
        Lie{"a_distance_less",
            [](auto& s) { s.mutable_distance()->RemoveLast(); },
            errc::column_length_wrong},
        Lie{"a_quality_less", [](auto& s) { s.set_quality("ab"); }, errc::column_length_wrong},
        Lie{"a_quality_more", [](auto& s) { s.set_quality("abcd"); }, errc::column_length_wrong},
        Lie{"no_time_step", [](auto& s) { s.clear_time_step_ps(); }, errc::column_length_wrong},
        Lie{"a_time_step_without_run",
            [](auto& s) { s.add_time_step_ps(1); },
            errc::column_length_wrong},
        Lie{"a_run_of_nothing",
            [](auto& s) {
                s.add_time_step_ps(1);
                s.add_time_run(0);
            },
            errc::column_length_wrong},
        Lie{"a_run_beyond_the_samples",
            [](auto& s) { s.set_time_run(0, 4); },
            errc::column_length_wrong},
        Lie{"a_run_that_ends_early",
            [](auto& s) { s.set_time_run(0, 2); },
            errc::column_length_wrong},
        Lie{"times_that_are_said_to_be_left_out",
            [](auto& s) { s.add_left_out(v1::TIME); },
            errc::column_length_wrong},
        Lie{"a_flag_without_place",
            [](auto& s) { s.clear_flag_index(); },
            errc::column_length_wrong},
        Lie{"a_place_without_flag",
            [](auto& s) { s.clear_flag_value(); },
            errc::column_length_wrong},
        Lie{"too_many",
            [](auto& s) {
                s.mutable_angle()->Resize(65537, 0);
                s.mutable_distance()->Resize(65537, 0);
            },
            errc::too_many_samples}
    ),
    [](const auto& test) { return test.param.name; }
);

INSTANTIATE_TEST_SUITE_P(
    Values,
    HostileColumnsTest,
    testing::Values(
        Lie{"angle_unit_of_zero",
            [](auto& s) { s.set_angle_units_per_turn(0); },
            errc::unit_unknown},
        Lie{"angle_unit_finer_than_any",
            [](auto& s) { s.set_angle_units_per_turn(65537); },
            errc::unit_unknown},
        Lie{"ramp_longer_than_any_scan",
            [](auto& s) {
                s.clear_angle();
                s.mutable_ramps()->set_length(65537);
            },
            errc::angle_out_of_range},
        Lie{"first_angle_negative", [](auto& s) { s.set_angle(0, -1); }, errc::angle_out_of_range},
        Lie{"first_angle_a_whole_turn",
            [](auto& s) { s.set_angle(0, 23040); },
            errc::angle_out_of_range},
        Lie{"step_of_a_whole_turn",
            [](auto& s) { s.set_angle(1, 23040); },
            errc::angle_out_of_range},
        Lie{"step_of_a_whole_turn_back",
            [](auto& s) { s.set_angle(1, -23040); },
            errc::angle_out_of_range},
        Lie{"largest_step", [](auto& s) { s.set_angle(2, largest32); }, errc::angle_out_of_range},
        Lie{"smallest_step", [](auto& s) { s.set_angle(2, smallest32); }, errc::angle_out_of_range},
        Lie{"distance_unit_of_zero",
            [](auto& s) { s.set_distance_unit_um(0); },
            errc::unit_unknown},
        Lie{"distance_unit_above_a_metre",
            [](auto& s) { s.set_distance_unit_um(1'000'001); },
            errc::unit_unknown},
        Lie{"negative_distance",
            [](auto& s) { s.set_distance(0, 2); },
            errc::distance_out_of_range},
        Lie{"echo_at_zero", [](auto& s) { s.set_distance(0, 1); }, errc::distance_out_of_range},
        Lie{"distance_back_to_zero",
            [](auto& s) { s.set_distance(1, 2); },
            errc::distance_out_of_range},
        Lie{"distance_past_32_bits",
            [](auto& s) { s.set_distance(1, 1 + 2 * (0xFFFFFFFFULL / 4 + 1)); },
            errc::distance_out_of_range},
        Lie{"farthest_step",
            [](auto& s) { s.set_distance(2, std::numeric_limits<std::uint64_t>::max()); },
            errc::distance_out_of_range},
        Lie{"nearest_step",
            [](auto& s) { s.set_distance(2, std::numeric_limits<std::uint64_t>::max() - 1); },
            errc::distance_out_of_range},
        Lie{"quality_above_a_byte",
            [](auto& s) { s.set_echo_quality(256); },
            errc::quality_out_of_range},
        Lie{"flag_above_a_byte", [](auto& s) { s.set_flag(256); }, errc::flag_out_of_range},
        Lie{"flag_after_the_last_sample",
            [](auto& s) { s.set_flag_index(0, 3); },
            errc::flag_out_of_range},
        Lie{"flag_far_after_the_last_sample",
            [](auto& s) { s.set_flag_index(0, 0xFFFFFFFF); },
            errc::flag_out_of_range},
        Lie{"flag_twice_for_a_sample",
            [](auto& s) {
                s.add_flag_index(0);
                s.set_flag_value("ab");
            },
            errc::flag_out_of_range},
        Lie{"flag_around_32_bits",
            [](auto& s) {
                s.set_flag_index(0, 2);
                s.add_flag_index(0xFFFFFFFF);
                s.set_flag_value("ab");
            },
            errc::flag_out_of_range},
        Lie{"flag_without_samples",
            [](auto& s) {
                s.clear_angle();
                s.clear_distance();
            },
            errc::flag_out_of_range},
        Lie{"no_answer_type", [](auto& s) { s.clear_answer_type(); }, errc::answer_type_unknown},
        Lie{"answer_type_of_none",
            [](auto& s) { s.set_answer_type(0x87); },
            errc::answer_type_unknown},
        Lie{"answer_type_above_a_byte",
            [](auto& s) { s.set_answer_type(0x182); },
            errc::answer_type_unknown}
    ),
    [](const auto& test) { return test.param.name; }
);

TEST(HostileColumns, MayHaveAnyTimesAtAll) {
    auto scan = honest_scan();
    scan.set_first_monotonic_ns(std::numeric_limits<std::uint64_t>::max());
    scan.set_time_step_ps(0, std::numeric_limits<std::int64_t>::max());
    scan.set_time_run(0, 2);
    scan.add_time_step_ps(std::numeric_limits<std::int64_t>::min());
    scan.add_time_run(1);
    EXPECT_TRUE(from_columns(scan).has_value());
}

}  // namespace
}  // namespace sweepcast::frame
