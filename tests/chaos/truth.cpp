#include "tests/chaos/truth.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <stdexcept>

namespace sweepcast::chaos {

namespace {

/// Samples kept: ten seconds of the fastest lidar.
constexpr std::size_t most_kept = 320'000;
/// A silence longer than this ends a scan, so that no sweep reaches over it.
constexpr std::chrono::milliseconds longest_hole{2500};

std::uint8_t hex_byte(std::string_view digits) {
    std::uint8_t byte = 0;
    const auto [stop, failure] = std::from_chars(digits.data(), digits.data() + 2, byte, 16);
    if (failure != std::errc{} || stop != digits.data() + 2) {
        throw std::runtime_error("a truth file that is not hex");
    }
    return byte;
}

}  // namespace

bool Truth::Measurement::operator==(const protocol::Sample& sample) const {
    if (sample.angle.raw != angle) {
        return false;
    }
    return (sample.distance.raw == distance && sample.quality == quality) ||
           (out_of_range && sample.distance.raw == 0 && sample.quality == 0);
}

void Truth::take(std::string_view text) {
    for (auto end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
        line_ += text.substr(0, end);
        text.remove_prefix(end + 1);
        take_line(line_);
        line_.clear();
    }
    line_ += text;
}

void Truth::take_line(std::string_view line) {
    if (line.starts_with('#')) {
        return;
    }
    const auto space = line.rfind(' ');
    if (const auto stream = line.substr(0, space); stream != stream_) {
        stream_ = stream;
        const auto type = protocol::AnswerType(hex_byte(line.substr(space - 2)));
        const auto& mode = *virtual_lidar::find_mode(*persona_, type);
        max_distance_mm_ = mode.max_distance_q8_m * 1000.0 / 256.0;
        decoder_ = protocol::Decoder::create(type, {mode.sample_duration(), persona_->baud, false})
                       .value();
    }
    bytes_.clear();
    for (auto hex = line.substr(space + 1); hex.size() >= 2; hex.remove_prefix(2)) {
        bytes_.push_back(hex_byte(hex));
    }
    decoded_.clear();
    decoder_->push(bytes_, {}, decoded_);
    for (const auto& sample : decoded_.samples) {
        measured_.push_back(
            {sample.distance.raw,
             sample.angle.raw,
             sample.quality,
             sample.distance.millimetres() > max_distance_mm_}
        );
    }
    if (measured_.size() > most_kept) {
        forget(measured_.size() - most_kept);
    }
}

Found Truth::find(std::span<const protocol::Sample> samples, protocol::AnswerType type) {
    if (samples.empty()) {
        return Found::whole;
    }
    const auto* const mode = virtual_lidar::find_mode(*persona_, type);
    if (mode == nullptr) {
        return Found::no;
    }
    const auto hole = static_cast<std::size_t>(longest_hole / mode->sample_duration());
    std::optional<std::size_t> first;
    for (std::size_t begin = 0; begin < measured_.size(); ++begin) {
        if (!(measured_[begin] == samples.front())) {
            continue;
        }
        if (!first) {
            first = begin;
        }
        if (const auto end = match_whole(begin, samples)) {
            forget(*end);
            return Found::whole;
        }
    }
    for (auto begin = first.value_or(measured_.size()); begin < measured_.size(); ++begin) {
        if (!(measured_[begin] == samples.front())) {
            continue;
        }
        if (const auto end = match_with_holes(begin, samples, samples.size() + hole)) {
            forget(*end);
            return Found::with_holes;
        }
    }
    return Found::no;
}

std::vector<std::size_t> Truth::unknown(std::span<const protocol::Sample> samples) const {
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (std::ranges::none_of(measured_, [&](const auto& each) { return each == samples[i]; })) {
            places.push_back(i);
        }
    }
    return places;
}

std::optional<std::size_t>
Truth::match_whole(std::size_t begin, std::span<const protocol::Sample> samples) const {
    if (measured_.size() - begin < samples.size()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!(measured_[begin + i] == samples[i])) {
            return std::nullopt;
        }
    }
    return begin + samples.size();
}

std::optional<std::size_t> Truth::match_with_holes(
    std::size_t begin,
    std::span<const protocol::Sample> samples,
    std::size_t longest
) const {
    const auto end = std::min(measured_.size(), begin + longest);
    auto next = samples.begin();
    for (auto i = begin; i < end; ++i) {
        if (measured_[i] == *next && ++next == samples.end()) {
            return i + 1;
        }
    }
    return std::nullopt;
}

void Truth::forget(std::size_t count) {
    measured_.erase(measured_.begin(), measured_.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace sweepcast::chaos
