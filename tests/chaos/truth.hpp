// Truth: what a virtual lidar measured, as it writes it with --truth, and whether a sweep is of it.
#pragma once

#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/decode.hpp"
#include "driver/protocol/sample.hpp"
#include "driver/virtual/persona.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::chaos {

/// How a sweep was found in what was measured.
enum class Found : std::uint8_t {
    no,
    whole,       ///< sample after sample
    with_holes,  ///< in order, but measurements between its samples did not arrive
};

/// The last seconds of what one lidar measured, decoded from the packets before anything happened
/// to them. A sweep's samples are looked for in order, and after those of the sweep found before:
/// none may come twice. Compared are angle, distance and quality, bit for bit; not times and flags.
class Truth {
public:
    explicit Truth(const virtual_lidar::Persona& persona) : persona_(&persona) {}

    /// Takes text of the truth file, cut anywhere.
    void take(std::string_view text);

    /// Looks for these samples. What is found, and all before it, is forgotten.
    Found find(std::span<const protocol::Sample> samples, protocol::AnswerType type);

    /// Which of these samples were not measured at all, by their places.
    [[nodiscard]] std::vector<std::size_t> unknown(std::span<const protocol::Sample> samples) const;

private:
    struct Measurement {
        std::uint32_t distance{};
        std::uint16_t angle{};
        std::uint8_t quality{};
        bool out_of_range{};  ///< the driver gives such a distance as no echo
        bool operator==(const protocol::Sample& sample) const;
    };

    void take_line(std::string_view line);
    [[nodiscard]] std::optional<std::size_t>
    match_whole(std::size_t begin, std::span<const protocol::Sample> samples) const;
    [[nodiscard]] std::optional<std::size_t> match_with_holes(
        std::size_t begin,
        std::span<const protocol::Sample> samples,
        std::size_t longest
    ) const;
    void forget(std::size_t count);

    const virtual_lidar::Persona* persona_;
    std::string line_;
    std::string stream_;  // number and answer type of the scan under way
    double max_distance_mm_{};
    std::optional<protocol::Decoder> decoder_;
    protocol::Decoded decoded_;
    std::vector<std::uint8_t> bytes_;
    std::deque<Measurement> measured_;
};

}  // namespace sweepcast::chaos
