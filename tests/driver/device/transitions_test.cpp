// The table of a lidar's life, and its drawing.
#include "driver/device/transitions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace sweepcast::device {
namespace {

TEST(TransitionsTest, AnEventLeadsToOnePhase) {
    std::set<std::pair<Phase, Event>> pairs;
    for (const auto& row : transitions()) {
        EXPECT_TRUE(pairs.insert({row.from, row.event}).second)
            << name(row.from) << ", " << name(row.event) << " is there twice";
    }
}

TEST(TransitionsTest, WhatIsNotInTheTableMustNotHappen) {
    EXPECT_EQ(next(Phase::starting, Event::samples), Phase::scanning);
    EXPECT_EQ(next(Phase::absent, Event::samples), std::nullopt);
    EXPECT_EQ(next(Phase::idle, Event::stall), std::nullopt);
}

std::set<Phase> reachable_from(Phase start) {
    std::set<Phase> found{start};
    for (bool more = true; more;) {
        more = false;
        for (const auto& row : transitions()) {
            more |= found.contains(row.from) && found.insert(row.to).second;
        }
    }
    return found;
}

TEST(TransitionsTest, EveryPhaseComesAboutAndScanningCanBeReachedFromIt) {
    EXPECT_EQ(reachable_from(Phase::disconnected).size(), all_phases.size());
    for (const auto phase : all_phases) {
        EXPECT_TRUE(reachable_from(phase).contains(Phase::scanning)) << name(phase);
    }
}

TEST(TransitionsTest, TheGatewayCanEndInEveryPhaseAndTheLineBreakInEveryOneWithAPort) {
    for (const auto phase : all_phases) {
        EXPECT_EQ(next(phase, Event::shutdown), Phase::disconnected) << name(phase);
        if (phase != Phase::disconnected && phase != Phase::backing_off) {
            EXPECT_EQ(next(phase, Event::lost), Phase::backing_off) << name(phase);
        }
    }
}

/// The arrows of the drawing, as "from --> to: event".
std::set<std::string> arrows_drawn() {
    std::ifstream file(SWEEPCAST_ROOT "/driver/device/STATES.md");
    std::set<std::string> arrows;
    const std::regex arrow(R"(^\s*(\w+) --> (\w+) : (.+)$)");
    for (std::string line; std::getline(file, line);) {
        std::smatch match;
        if (!std::regex_match(line, match, arrow)) {
            continue;
        }
        std::string events = match[3];
        for (std::size_t at = 0; at != std::string::npos;) {
            const auto comma = events.find(", ", at);
            arrows.insert(
                match[1].str() + " --> " + match[2].str() + ": " + events.substr(at, comma - at)
            );
            at = comma == std::string::npos ? comma : comma + 2;
        }
    }
    return arrows;
}

std::string identifier(std::string_view words) {
    std::string text(words);
    for (auto& letter : text) {
        letter = letter == ' ' ? '_' : letter;
    }
    return text;
}

TEST(TransitionsTest, TheDrawingShowsTheTable) {
    std::set<std::string> rows;
    for (const auto& row : transitions()) {
        // Every phase has these two: the drawing says so once.
        const bool everywhere = row.event == Event::shutdown || row.event == Event::lost;
        if (!everywhere && row.from != row.to) {
            rows.insert(
                identifier(name(row.from)) + " --> " + identifier(name(row.to)) + ": " +
                std::string(name(row.event))
            );
        }
    }
    EXPECT_THAT(arrows_drawn(), testing::ContainerEq(rows));
}

}  // namespace
}  // namespace sweepcast::device
