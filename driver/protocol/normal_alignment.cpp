// Weighing the five ways in which a normal scan may be cut into packets.
#include "driver/protocol/normal_alignment.hpp"

#include <algorithm>
#include <array>
#include <optional>

namespace sweepcast::protocol {
namespace {

constexpr int lock_score = 8;
constexpr int rival_score = 4;
constexpr int highest_score = 12;
constexpr int failure_cost = 3;
constexpr int continuity_gain = 3;
constexpr int in_place_score = 6;

/// The evidence for one alignment.
struct Candidate {
    int score{};
    std::optional<std::size_t> begin;  ///< its first packet since the score was last 0
    AngleQ14 angle{};

    void weigh(const std::uint8_t* packet, std::size_t offset) {
        if (!is_normal_packet(packet)) {
            if (offset == 0) {
                return;  // that is why we are here: it says nothing about the packets after it
            }
            score = std::max(score - failure_cost, 0);
            if (score == 0) {
                begin.reset();
            }
            return;
        }
        const auto next = normal_angle(packet);
        const bool continues = angle_continues(angle, next) && !normal_starts_revolution(packet);
        score = std::min(score + (continues ? continuity_gain : 1), highest_score);
        begin = begin.value_or(offset);
        angle = next;
    }
};

using Candidates = std::array<Candidate, normal_packet_size>;

bool leads(const Candidate& candidate, const Candidates& all) {
    return candidate.score >= lock_score &&
           std::all_of(all.begin(), all.end(), [&](const Candidate& other) {
               return &other == &candidate || other.score < rival_score;
           });
}

/// The verdict when no more bytes may be awaited.
Alignment decide(const Candidates& candidates, std::size_t weighed) {
    const auto best = std::max_element(
        candidates.begin(),
        candidates.end(),
        [](const Candidate& a, const Candidate& b) { return a.score < b.score; }
    );
    if (best->score >= lock_score) {
        return {Alignment::Verdict::found, *best->begin};
    }
    auto first_alive = weighed;
    for (const auto& candidate : candidates) {
        first_alive = std::min(first_alive, candidate.begin.value_or(weighed));
    }
    return {Alignment::Verdict::nothing, std::max<std::size_t>(first_alive, 1)};
}

}  // namespace

Alignment find_alignment(std::span<const std::uint8_t> bytes, const AlignmentPrior& prior) {
    Candidates candidates{};
    for (auto& candidate : candidates) {
        candidate.angle = prior.last_angle;
    }
    candidates[0].score = prior.in_place ? in_place_score : 0;

    bytes = bytes.first(std::min(bytes.size(), alignment_window));
    std::size_t offset = 0;
    for (; offset + normal_packet_size <= bytes.size(); ++offset) {
        auto& candidate = candidates[offset % normal_packet_size];
        candidate.weigh(bytes.data() + offset, offset);
        if (leads(candidate, candidates)) {
            return {Alignment::Verdict::found, *candidate.begin};
        }
    }
    if (bytes.size() < alignment_window) {
        return {};
    }
    return decide(candidates, offset);
}

}  // namespace sweepcast::protocol
