// The response descriptor is found in whatever else the line carries, and nothing else is taken for
// it.
#include "driver/protocol/descriptor_hunter.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace sweepcast::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes info_descriptor{0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00, 0x04};

Bytes operator+(Bytes front, const Bytes& back) {
    front.insert(front.end(), back.begin(), back.end());
    return front;
}

struct HuntCase {
    std::string name;
    Bytes before;
};

class HuntTest : public testing::TestWithParam<HuntCase> {};

TEST_P(HuntTest, FindsTheDescriptorBehindOtherBytes) {
    const auto& before = GetParam().before;
    DescriptorHunter hunter{Expectation::device_info()};
    const auto step = hunter.push(before + info_descriptor + Bytes{1, 2, 3});
    EXPECT_EQ(step.found, (Descriptor{20, false, 0x04}));
    EXPECT_EQ(step.consumed, before.size() + descriptor_size);
    EXPECT_EQ(hunter.skipped(), before.size());
}

TEST_P(HuntTest, FindsItByteByByteToo) {
    const auto bytes = GetParam().before + info_descriptor;
    DescriptorHunter hunter{Expectation::device_info()};
    for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
        const auto step = hunter.push(std::span(bytes).subspan(i, 1));
        ASSERT_EQ(step.found, std::nullopt) << "byte " << i;
        ASSERT_EQ(step.consumed, 1U);
    }
    EXPECT_TRUE(hunter.push(std::span(bytes).last(1)).found);
    EXPECT_EQ(hunter.skipped(), GetParam().before.size());
}

INSTANTIATE_TEST_SUITE_P(
    Behind,
    HuntTest,
    testing::Values(
        HuntCase{"nothing", {}},
        HuntCase{"boot_text", {'R', 'P', ' ', 'L', 'I', 'D', 'A', 'R', '\r', '\n'}},
        HuntCase{"a_doubled_start", {0xA5}},
        HuntCase{"many_starts", {0xA5, 0xA5, 0xA5, 0xA5, 0xA5, 0xA5, 0xA5, 0xA5}},
        HuntCase{"both_sync_bytes", {0xA5, 0x5A}},
        HuntCase{"a_beginning", {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x00}},
        HuntCase{"sync_bytes_and_a_start", {0xA5, 0x5A, 0xA5}},
        HuntCase{"a_gigabyte", {0xA5, 0x5A, 0xFF, 0xFF, 0xFF, 0x3F, 0x04}},
        HuntCase{"length_zero", {0xA5, 0x5A, 0x00, 0x00, 0x00, 0x00, 0x04}},
        HuntCase{"one_byte_too_long", {0xA5, 0x5A, 0x15, 0x00, 0x00, 0x00, 0x04}},
        HuntCase{"another_reply", {0xA5, 0x5A, 0x03, 0x00, 0x00, 0x00, 0x06}},
        HuntCase{"a_stream", {0xA5, 0x5A, 0x05, 0x00, 0x00, 0x40, 0x81}},
        HuntCase{"the_wrong_mode", {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x40, 0x04}},
        HuntCase{"a_reserved_mode", {0xA5, 0x5A, 0x14, 0x00, 0x00, 0x80, 0x04}}
    ),
    [](const auto& tested) { return tested.param.name; }
);

TEST(DescriptorHunterTest, FindsOneAfterAnother) {
    DescriptorHunter hunter{Expectation::device_info()};
    const auto bytes = info_descriptor + info_descriptor;
    ASSERT_EQ(hunter.push(bytes).consumed, descriptor_size);
    EXPECT_TRUE(hunter.push(std::span(bytes).subspan(descriptor_size)).found);
}

TEST(DescriptorHunterTest, FindsNothingInRandomBytesThatHoldNone) {
    std::mt19937 random(1);
    DescriptorHunter hunter{Expectation::health()};
    Bytes bytes(100'000);
    for (auto& byte : bytes) {
        byte = static_cast<std::uint8_t>(random());
    }
    const auto step = hunter.push(bytes);
    EXPECT_EQ(step.found, std::nullopt);
    EXPECT_EQ(step.consumed, bytes.size());
    EXPECT_GT(hunter.skipped(), bytes.size() - descriptor_size);
}

struct DescriptorCase {
    std::string name;
    Expectation expectation;
    Descriptor descriptor;
    Bytes bytes;
};

class DescriptorTest : public testing::TestWithParam<DescriptorCase> {};

TEST_P(DescriptorTest, IsWrittenAsTheProtocolSays) {
    const auto bytes = encode_descriptor(GetParam().descriptor);
    EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), GetParam().bytes);
}

TEST_P(DescriptorTest, IsFoundByWhoExpectsIt) {
    DescriptorHunter hunter{GetParam().expectation};
    EXPECT_EQ(hunter.push(GetParam().bytes).found, GetParam().descriptor);
}

INSTANTIATE_TEST_SUITE_P(
    Known,
    DescriptorTest,
    testing::Values(
        DescriptorCase{
            "info",
            Expectation::device_info(),
            {20, false, 0x04},
            {0xA5, 0x5A, 0x14, 0, 0, 0, 0x04}},
        DescriptorCase{
            "health",
            Expectation::health(),
            {3, false, 0x06},
            {0xA5, 0x5A, 3, 0, 0, 0, 0x06}},
        DescriptorCase{
            "rate",
            Expectation::sample_rate(),
            {4, false, 0x15},
            {0xA5, 0x5A, 4, 0, 0, 0, 0x15}},
        DescriptorCase{
            "echo_of_conf",
            Expectation::lidar_conf(),
            {4, false, 0x20},
            {0xA5, 0x5A, 4, 0, 0, 0, 0x20}},
        DescriptorCase{
            "longest_conf",
            Expectation::lidar_conf(),
            {1024, false, 0x20},
            {0xA5, 0x5A, 0, 4, 0, 0, 0x20}},
        DescriptorCase{
            "set_conf",
            Expectation::set_lidar_conf(),
            {8, false, 0x21},
            {0xA5, 0x5A, 8, 0, 0, 0, 0x21}},
        DescriptorCase{
            "acc_board",
            Expectation::acc_board_flag(),
            {4, false, 0xFF},
            {0xA5, 0x5A, 4, 0, 0, 0, 0xFF}},
        DescriptorCase{
            "normal",
            Expectation::measurement(),
            {5, true, 0x81},
            {0xA5, 0x5A, 5, 0, 0, 0x40, 0x81}},
        DescriptorCase{
            "express",
            Expectation::measurement(),
            {84, true, 0x82},
            {0xA5, 0x5A, 0x54, 0, 0, 0x40, 0x82}},
        DescriptorCase{
            "hq",
            Expectation::measurement(),
            {781, true, 0x83},
            {0xA5, 0x5A, 0x0D, 3, 0, 0x40, 0x83}},
        DescriptorCase{
            "ultra",
            Expectation::measurement(),
            {132, true, 0x84},
            {0xA5, 0x5A, 0x84, 0, 0, 0x40, 0x84}},
        DescriptorCase{
            "dense",
            Expectation::measurement(),
            {84, true, 0x85},
            {0xA5, 0x5A, 0x54, 0, 0, 0x40, 0x85}},
        DescriptorCase{
            "ultra_dense",
            Expectation::measurement(),
            {170, true, 0x86},
            {0xA5, 0x5A, 0xAA, 0, 0, 0x40, 0x86}}
    ),
    [](const auto& tested) { return tested.param.name; }
);

TEST(ExpectationTest, AStreamMustHaveThePacketSizeOfItsOwnType) {
    const auto expectation = Expectation::measurement();
    EXPECT_FALSE(expectation.admits({84, true, 0x81}));
    EXPECT_FALSE(expectation.admits({84, true, 0x84}));
    EXPECT_FALSE(expectation.admits({84, false, 0x82}));
    EXPECT_FALSE(expectation.admits({84, true, 0x87}));
}

TEST(ExpectationTest, AConfReplyHasAtLeastItsEchoAndAtMostAKilobyte) {
    const auto expectation = Expectation::lidar_conf();
    EXPECT_FALSE(expectation.admits({3, false, 0x20}));
    EXPECT_FALSE(expectation.admits({max_packet_length + 1, false, 0x20}));
}

}  // namespace
}  // namespace sweepcast::protocol
