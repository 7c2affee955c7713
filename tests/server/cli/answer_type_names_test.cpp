// Answer types by number and by name.
#include "server/cli/answer_type_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sweepcast::cli {
namespace {

using protocol::AnswerType;

TEST(AnswerTypeNamesTest, ATypeIsKnownByItsNumberAndByItsName) {
    for (const auto* text : {"0x86", "86", "ultra-dense"}) {
        const auto type = parse_answer_type(text);
        ASSERT_TRUE(type) << text;
        EXPECT_EQ(*type, AnswerType::ultra_dense) << text;
    }
    EXPECT_EQ(*parse_answer_type("normal"), AnswerType::normal);
}

TEST(AnswerTypeNamesTest, WhatIsNoneGetsTheListOfThoseThatAre) {
    for (const auto* text : {"", "0x", "0x87", "134", "Ultra", "ultra ", "84\n"}) {
        const auto type = parse_answer_type(text);
        ASSERT_FALSE(type) << text;
        EXPECT_THAT(type.error().hint, testing::HasSubstr("0x84 (ultra), 0x85 (dense)"));
    }
}

TEST(AnswerTypeNamesTest, AreShownWithNumberAndName) {
    EXPECT_EQ(shown_answer_type(AnswerType::hq), "0x83 (hq)");
    EXPECT_EQ(shown_answer_type(static_cast<AnswerType>(0x99)), "0x99");
}

}  // namespace
}  // namespace sweepcast::cli
