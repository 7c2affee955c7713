// What a sweep costs on the wire: bounds, so that a change that makes frames bigger is seen.
#include "server/frame/frame_encoder.hpp"
#include "tests/server/frame/random_sweep.hpp"

#include <gtest/gtest.h>

#include <iostream>
#include <string>

namespace sweepcast::frame {
namespace {

struct CostCase {
    std::string name;
    ScannerShape shape;
    double most_bytes_per_sample{};
};

class FrameCostTest : public testing::TestWithParam<CostCase> {};

TEST_P(FrameCostTest, StaysBelowItsBound) {
    constexpr int sweeps = 20;
    std::mt19937_64 random(1);  // NOLINT(cert-msc51-cpp): the same sweeps in every run
    FrameEncoder encoder;
    std::size_t zstd = 0;
    std::size_t none = 0;
    for (int i = 0; i < sweeps; ++i) {
        const auto captured = sweep_of_a_room(GetParam().shape, random);
        zstd += encoder.encode(whole_sweep(captured), {.compression = Compression::zstd})
                    ->message()
                    .size();
        none += encoder.encode(whole_sweep(captured), {.compression = Compression::none})
                    ->message()
                    .size();
    }
    const auto samples = static_cast<double>(sweeps * GetParam().shape.samples);
    std::cout << GetParam().name << ": " << zstd / sweeps << " bytes a sweep ("
              << static_cast<double>(zstd) / samples << " a sample), uncompressed " << none / sweeps
              << "\n";
    EXPECT_LT(static_cast<double>(zstd) / samples, GetParam().most_bytes_per_sample);
    EXPECT_LT(zstd, none);
}

using protocol::AnswerType;

INSTANTIATE_TEST_SUITE_P(
    Scanners,
    FrameCostTest,
    testing::Values(
        CostCase{"a1_standard", {360, 1, true, AnswerType::normal}, 3.3},
        CostCase{"a1_express", {800, 4, false, AnswerType::express}, 1.55},
        CostCase{"c1_dense", {500, 4, false, AnswerType::dense}, 1.8},
        CostCase{"s2_dense", {3200, 4, false, AnswerType::dense}, 1.05},
        CostCase{"s3_ultra_dense", {3200, 1, true, AnswerType::ultra_dense}, 2.15}
    ),
    [](const auto& test) { return test.param.name; }
);

}  // namespace
}  // namespace sweepcast::frame
