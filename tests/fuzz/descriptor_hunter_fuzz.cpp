// Any bytes as what a line carries after a request: the hunter finds the first descriptor that was
// asked for, wherever it lies and however the bytes are cut. The first two bytes choose what is
// expected and the cuts.
#include "driver/protocol/descriptor_hunter.hpp"
#include "tests/fuzz/fuzzing.hpp"

#include <array>

namespace sweepcast::fuzz {
namespace {

using namespace protocol;

Expectation expectation_from(std::uint8_t choice) {
    const std::array<Expectation, 7> all{
        Expectation::measurement(),
        Expectation::device_info(),
        Expectation::health(),
        Expectation::sample_rate(),
        Expectation::lidar_conf(),
        Expectation::set_lidar_conf(),
        Expectation::acc_board_flag()};
    return all[choice % all.size()];
}

/// What was found and where it ended; all of the input if nothing was.
struct Found {
    std::size_t end{};
    std::optional<Descriptor> descriptor;
    std::uint64_t skipped{};
    bool operator==(const Found&) const = default;
};

template <class NextSize>
Found hunt(const Expectation& expectation, Input bytes, NextSize next_size) {
    DescriptorHunter hunter{expectation};
    std::size_t end = 0;
    while (end < bytes.size()) {
        const auto piece = bytes.subspan(end, std::min(next_size(), bytes.size() - end));
        const auto step = hunter.push(piece);
        require(step.consumed <= piece.size());
        end += step.consumed;
        if (step.found) {
            return {end, step.found, hunter.skipped()};
        }
        require(step.consumed == piece.size());
    }
    return {end, std::nullopt, hunter.skipped()};
}

/// The first place where an expected descriptor lies, by trying each.
std::optional<std::size_t> first_place(const Expectation& expectation, Input bytes) {
    for (std::size_t at = 0; at + descriptor_size <= bytes.size(); ++at) {
        const auto piece = bytes.subspan(at, descriptor_size);
        const auto word =
            static_cast<std::uint32_t>(piece[2]) | static_cast<std::uint32_t>(piece[3]) << 8 |
            static_cast<std::uint32_t>(piece[4]) << 16 | static_cast<std::uint32_t>(piece[5]) << 24;
        if (piece[0] == 0xA5 && piece[1] == 0x5A && word >> 30 <= 1 &&
            expectation.admits({word & 0x3FFFFFFFU, word >> 30 == 1, piece[6]})) {
            return at;
        }
    }
    return std::nullopt;
}

}  // namespace
}  // namespace sweepcast::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace sweepcast::fuzz;
    Input input{data, size};
    const auto expectation = expectation_from(take_byte(input));
    Cuts cuts{take_byte(input)};
    const auto whole = hunt(expectation, input, [&] { return input.size(); });
    require(whole == hunt(expectation, input, [] { return std::size_t{1}; }));
    require(whole == hunt(expectation, input, [&] { return cuts.next(); }));
    const auto place = first_place(expectation, input);
    require(place.has_value() == whole.descriptor.has_value());
    if (place) {
        require(whole.end == *place + sweepcast::protocol::descriptor_size);
        require(whole.skipped == *place);
        require(whole.descriptor->length <= sweepcast::protocol::max_packet_length);
    }
    return 0;
}
