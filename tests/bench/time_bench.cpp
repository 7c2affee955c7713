// Measures, does not judge: how far the times of samples are from the truth, reckoned back from the
// arrival of each packet, and as the ScanReader gives them.
#include "tests/support/time_errors.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <string_view>

namespace {

using namespace sweepcast;
using namespace std::chrono_literals;
using protocol::AnswerType;

struct Case {
    std::string_view key;
    AnswerType type{};
};

constexpr std::array cases{
    Case{"a1m8", AnswerType::normal},
    Case{"s2", AnswerType::normal},
    Case{"a1m8", AnswerType::express},
    Case{"s3", AnswerType::hq},
    Case{"a2m12", AnswerType::ultra},
    Case{"s1", AnswerType::dense},
    Case{"s2", AnswerType::dense},
    Case{"c1", AnswerType::ultra_dense},
};

constexpr std::array lines{
    test::LineModel{.name = "exact"},
    test::LineModel{.name = "pty 0.3 ms", .jitter = 300us},
    test::LineModel{.name = "1 ms", .poll = 1ms, .jitter = 50us},
    test::LineModel{.name = "1 ms +200 ppm", .poll = 1ms, .jitter = 50us, .crystal_ppm = 200},
    test::LineModel{.name = "16 ms", .poll = 16ms, .jitter = 100us},
    test::LineModel{.name = "16 ms +200 ppm", .poll = 16ms, .jitter = 100us, .crystal_ppm = 200},
    test::LineModel{.name = "16 ms -200 ppm", .poll = 16ms, .jitter = 100us, .crystal_ppm = -200},
    test::LineModel{
        .name = "16 ms, clock 0.8 % off",
        .poll = 16ms,
        .jitter = 100us,
        .crystal_ppm = 8000},
    test::LineModel{.name = "16 ms, 1 % lost", .poll = 16ms, .jitter = 100us, .lost = 0.01},
    test::LineModel{.name = "16 ms, 1 % damaged", .poll = 16ms, .jitter = 100us, .damaged = 0.01},
};

}  // namespace

int main(int count, char** arguments) {
    const std::string_view only = count > 1 ? arguments[1] : "";
    std::printf(
        "%-6s %-4s %-23s | %30s | %30s | %s\n%-36s| %7s %7s %7s %5s  | %7s %7s %7s %5s  | %7s "
        "%7s\n",
        "lidar",
        "type",
        "line",
        "reckoned back, us",
        "as read, us",
        "stated",
        "",
        "median",
        "p99",
        "max",
        "back",
        "median",
        "p99",
        "max",
        "back",
        "median",
        "holds %"
    );
    for (const auto& each : cases) {
        for (const auto& line : lines) {
            if (line.name.find(only) == std::string_view::npos) {
                continue;
            }
            const test::LineScan scan(each.key, each.type, line, 30s);
            const auto before = test::time_errors(scan, test::reckoned_back(scan, each.type));
            const auto after = test::time_errors(scan, test::as_read(scan, each.type));
            std::printf(
                "%-6.*s 0x%02x %-23.*s | %7.0f %7.0f %7.0f %5zu  | %7.0f %7.0f %7.0f %5zu  | %7.0f "
                "%7.1f\n",
                static_cast<int>(each.key.size()),
                each.key.data(),
                static_cast<unsigned>(each.type),
                static_cast<int>(line.name.size()),
                line.name.data(),
                before.median_us,
                before.p99_us,
                before.greatest_us,
                before.back,
                after.median_us,
                after.p99_us,
                after.greatest_us,
                after.back,
                after.stated_us,
                100.0 * after.within
            );
        }
    }
}
