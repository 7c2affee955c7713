// PeekSource and SourceStream: bytes looked at are not lost, however they come.
#include "server/cli/byte_source.hpp"

#include "server/cli/source_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace sweepcast::cli {
namespace {

/// Gives these blocks, then the end or, if there is one, a problem.
class Blocks final : public ByteSource {
public:
    explicit Blocks(std::vector<std::string> blocks, std::optional<Problem> problem = {})
        : blocks_(std::move(blocks))
        , problem_(std::move(problem)) {}

    Result<std::span<const std::uint8_t>, Problem> next() override {
        if (at_ == blocks_.size()) {
            if (problem_) {
                return *problem_;
            }
            return std::span<const std::uint8_t>();
        }
        const auto& block = blocks_[at_++];
        bytes_.assign(block.begin(), block.end());
        return std::span<const std::uint8_t>(bytes_);
    }

    [[nodiscard]] std::size_t given() const { return at_; }

private:
    std::vector<std::string> blocks_;
    std::optional<Problem> problem_;
    std::size_t at_{};
    std::vector<std::uint8_t> bytes_;
};

std::string all_of(ByteSource& source) {
    SourceStream stream(source);
    std::ostringstream all;
    for (char c = 0; stream.get(c);) {
        all << c;
    }
    return all.str();
}

struct Peeked {
    std::vector<std::string> blocks;
    bool begins{};
};

class PeekSourceTest : public testing::TestWithParam<Peeked> {};

TEST_P(PeekSourceTest, SeesHowItBeginsAndGivesItAll) {
    PeekSource source(std::make_unique<Blocks>(GetParam().blocks));
    EXPECT_EQ(*source.begins_with("magic"), GetParam().begins);
    std::string whole;
    for (const auto& block : GetParam().blocks) {
        whole += block;
    }
    EXPECT_EQ(all_of(source), whole);
}

INSTANTIATE_TEST_SUITE_P(
    Beginnings,
    PeekSourceTest,
    testing::Values(
        Peeked{{}, false},
        Peeked{{"magic"}, true},
        Peeked{{"magic and more", "and more"}, true},
        Peeked{{"m", "a", "gi", "c", "!"}, true},
        Peeked{{"mag"}, false},
        Peeked{{"mag", "netic"}, false},
        Peeked{{"\xA5\x5A", "magic"}, false}
    )
);

TEST(PeekSource, WaitsForNoMoreThanItNeedsToTell) {
    auto blocks = std::make_unique<Blocks>(std::vector<std::string>{"x", "yz"});
    const auto& given = *blocks;
    PeekSource source(std::move(blocks));
    EXPECT_FALSE(*source.begins_with("magic"));
    EXPECT_EQ(given.given(), 1U);
}

TEST(SourceStream, EndsAtAProblemAndKeepsIt) {
    Blocks source({"abc"}, Problem{{}, "broken", ""});
    SourceStream stream(source);
    std::string text;
    stream >> text;
    EXPECT_EQ(text, "abc");
    EXPECT_TRUE(stream.eof());
    ASSERT_TRUE(stream.problem());
    EXPECT_EQ(stream.problem()->cause, "broken");
}

}  // namespace
}  // namespace sweepcast::cli
