#include "driver/diagnosis/heard.hpp"

#include "driver/protocol/decode.hpp"
#include "driver/protocol/descriptor_hunter.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace sweepcast::diagnosis {

namespace {

using protocol::AnswerType;

/// The word that is in every boot text seen, and in no other device's.
constexpr std::string_view lidar_word = "LIDAR";
constexpr std::size_t quoted_at_most = 80;

bool is_text(std::uint8_t byte) {
    return (byte >= 0x20 && byte < 0x7f) || byte == '\r' || byte == '\n' || byte == '\t';
}

/// The bytes in one line of printable ASCII, line ends as " / ".
std::string quote(std::span<const std::uint8_t> bytes) {
    std::string text;
    for (const auto byte : bytes) {
        if (text.size() >= quoted_at_most) {
            break;
        }
        const bool line_end = byte == '\r' || byte == '\n';
        if (!line_end && is_text(byte)) {
            text += byte == '\t' ? ' ' : static_cast<char>(byte);
        } else if (line_end && !text.empty() && !text.ends_with(" / ")) {
            text += " / ";
        }
    }
    if (text.ends_with(" / ")) {
        text.resize(text.size() - 3);
    }
    return text;
}

/// Where the word is in `bytes`, from `from` on; bytes.size() if nowhere.
std::size_t
find_word(std::span<const std::uint8_t> bytes, std::string_view word, std::size_t from = 0) {
    const auto found = std::search(
        bytes.begin() + static_cast<std::ptrdiff_t>(from),
        bytes.end(),
        word.begin(),
        word.end(),
        [](std::uint8_t byte, char letter) { return std::toupper(byte) == letter; }
    );
    return static_cast<std::size_t>(found - bytes.begin());
}

/// Puts the answer to GET_INFO, or its beginning, into `heard`. False if there is none.
bool find_answer(std::span<const std::uint8_t> bytes, Heard& heard) {
    protocol::DescriptorHunter hunter(protocol::Expectation::device_info());
    const auto step = hunter.push(bytes);
    if (!step.found) {
        return false;
    }
    heard.kind = HeardKind::answer;
    const auto rest = bytes.subspan(step.consumed);
    if (rest.size() >= protocol::device_info_size) {
        if (const auto info =
                protocol::decode_device_info(rest.first(protocol::device_info_size))) {
            heard.info = *info;
        }
    }
    return true;
}

constexpr std::array answer_types{
    AnswerType::normal,
    AnswerType::express,
    AnswerType::hq,
    AnswerType::ultra,
    AnswerType::dense,
    AnswerType::ultra_dense};

/// Whether the decoder of this type makes samples of all but a packet or two at the ends.
bool decodes_as(AnswerType type, std::span<const std::uint8_t> bytes) {
    constexpr std::chrono::microseconds any_duration{250};
    constexpr std::size_t enough_samples = 12;
    auto decoder = protocol::Decoder::create(type, {any_duration, 0, false});
    if (!decoder) {
        return false;
    }
    protocol::Decoded decoded;
    decoder->push(bytes, {}, decoded);
    const auto size = protocol::packet_size(type);
    const auto packets = decoded.samples.size() / protocol::samples_per_packet(type);
    // A packet may be cut off at either end, and capsules come out with their successor.
    return decoded.samples.size() >= enough_samples && (packets + 3) * size >= bytes.size();
}

/// Puts text, if that is what was heard, into `heard`.
bool find_text(std::span<const std::uint8_t> bytes, Heard& heard) {
    constexpr std::size_t shortest = 12;
    const auto lidar = find_word(bytes, lidar_word);
    if (lidar < bytes.size()) {
        heard.kind = HeardKind::boot_text;
        for (auto at = lidar; at < bytes.size(); at = find_word(bytes, lidar_word, at + 1)) {
            ++heard.boots;
        }
        auto begin = lidar;
        while (begin > 0 && is_text(bytes[begin - 1])) {
            --begin;
        }
        auto end = lidar;
        while (end < bytes.size() && is_text(bytes[end])) {
            ++end;
        }
        heard.text = quote(bytes.subspan(begin, end - begin));
        return true;
    }
    const auto printable = static_cast<std::size_t>(std::ranges::count_if(bytes, is_text));
    if (bytes.size() >= shortest && printable * 10 >= bytes.size() * 9) {
        heard.kind = HeardKind::text;
        heard.text = quote(bytes);
        return true;
    }
    return false;
}

}  // namespace

std::string_view name(HeardKind kind) {
    switch (kind) {
    case HeardKind::nothing:
        return "nothing";
    case HeardKind::noise:
        return "noise";
    case HeardKind::text:
        return "text";
    case HeardKind::boot_text:
        return "boot text";
    case HeardKind::scan_data:
        return "scan data";
    case HeardKind::answer:
        return "an answer";
    }
    return "unknown";
}

Heard classify(std::uint32_t baud, std::span<const std::uint8_t> bytes) {
    Heard heard;
    heard.baud = baud;
    heard.bytes = bytes.size();
    if (bytes.empty() || find_answer(bytes, heard) || find_text(bytes, heard)) {
        return heard;
    }
    const bool scan_data =
        std::ranges::any_of(answer_types, [&](AnswerType type) { return decodes_as(type, bytes); });
    heard.kind = scan_data ? HeardKind::scan_data : HeardKind::noise;
    return heard;
}

}  // namespace sweepcast::diagnosis
