#include "driver/virtual/playback.hpp"

#include "driver/protocol/model.hpp"
#include "driver/virtual/error.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <system_error>
#include <tuple>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace {

Problem unusable(std::string_view name, const std::string& why) {
    return {
        errc::capture_unusable,
        std::string(name) + ": " + why,
        "give a file that sweepcast capture has written"};
}

// The persona of this model; if there is none, the first whose motor is controlled as its.
const Persona& most_like(std::uint8_t model) {
    const auto all = personas();
    const auto same = std::ranges::find(all, model, &Persona::model);
    if (same != all.end()) {
        return *same;
    }
    const auto control = protocol::motor_control_of(model);
    const auto alike =
        std::ranges::find(all, control, [](const Persona& each) { return each.motor.control; });
    return alike != all.end() ? *alike : all.front();
}

// "1.29" to its two numbers; none if it is anything else.
std::optional<std::pair<std::uint8_t, std::uint8_t>> parse_firmware(std::string_view text) {
    std::uint8_t major = 0;
    std::uint8_t minor = 0;
    const auto* const end = text.data() + text.size();
    const auto [dot, failed] = std::from_chars(text.data(), end, major);
    if (failed != std::errc{} || dot == end || *dot != '.') {
        return std::nullopt;
    }
    const auto [stop, failed_too] = std::from_chars(dot + 1, end, minor);
    return failed_too == std::errc{} && stop == end ? std::optional(std::pair(major, minor))
                                                    : std::nullopt;
}

std::uint32_t in_q8_us(std::chrono::nanoseconds duration) {
    constexpr std::int64_t longest_ns = 1'000'000'000;
    const auto ns = std::clamp<std::int64_t>(duration.count(), 0, longest_ns);
    return static_cast<std::uint32_t>((ns * 256 + 500) / 1000);
}

// Scanners whose modes nobody can ask for have these two.
std::uint16_t legacy_mode_id(protocol::AnswerType type) {
    return type == protocol::AnswerType::normal ? 0 : 1;
}

}  // namespace

Playback::Playback(std::unique_ptr<std::istream> capture, bool loop)
    : capture_(std::move(capture))
    , loop_(loop) {}

Result<std::unique_ptr<Playback>, Problem>
Playback::open(std::unique_ptr<std::istream> capture, std::string_view name, bool loop) {
    std::unique_ptr<Playback> playback(new Playback(std::move(capture), loop));
    auto reader = capture::CaptureReader::open(*playback->capture_);
    if (!reader) {
        auto problem = std::move(reader).error();
        return unusable(name, problem.cause);
    }
    const auto header = reader->header();
    if (!playback->rewind()) {
        return unusable(name, "it holds no measurements");
    }
    playback->adopt(header);
    return playback;
}

Result<std::unique_ptr<Playback>, Problem> Playback::load(const std::string& path, bool loop) {
    errno = 0;
    auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
    if (!*file) {
        return unusable(path, std::strerror(errno));
    }
    return open(std::move(file), path, loop);
}

void Playback::adopt(const capture::CaptureHeader& header) {
    constexpr std::uint16_t most_modes = 64;
    const auto& like = most_like(header.model_id);
    persona_ = like;
    persona_.model = header.model_id;
    persona_.hardware = header.hardware;
    if (const auto firmware = parse_firmware(header.firmware)) {
        std::tie(persona_.firmware_major, persona_.firmware_minor) = *firmware;
    }
    const auto name = protocol::model_name(header.model_id);
    alias_ = header.model == name ? std::string() : header.model;
    title_ = "RPLIDAR " + (header.model.empty() ? name : header.model) + " of a capture";
    mode_name_ = header.mode.empty() ? "Captured" : header.mode;
    persona_.alias = alias_;
    persona_.title = title_;
    persona_.baud = header.baud != 0 ? header.baud : like.baud;
    serial_ = parse_serial(header.serial).value_or(serial_from(header.serial));

    const auto id =
        std::min<std::uint16_t>(header.mode_id.value_or(legacy_mode_id(type_)), most_modes - 1);
    modes_.assign(like.modes.begin(), like.modes.end());
    modes_.resize(std::max<std::size_t>(modes_.size(), id + 1U), modes_.front());
    modes_[id].name = mode_name_;
    modes_[id].answer = type_;
    modes_[id].sample_duration_q8_us = in_q8_us(header.sample_duration);
    persona_.modes = modes_;
    persona_.typical_mode = id;
}

// Back to the first block of the first stream. False if there is none.
bool Playback::rewind() {
    capture_->clear();
    capture_->seekg(0);
    auto reader = capture::CaptureReader::open(*capture_);
    if (!reader) {
        return false;
    }
    reader_.emplace(std::move(*reader));
    finder_ = {};
    while (const auto record = reader_->next()) {
        if (const auto block = finder_.push(*record)) {
            type_ = block->type;
            descriptor_at_ = block->at;
            last_at_ = block->at;
            block_.assign(block->bytes.begin(), block->bytes.end());
            played_ = 0;
            return true;
        }
    }
    return false;
}

// The next block of the stream. False at its end.
bool Playback::read_block() {
    while (const auto record = reader_->next()) {
        const auto block = finder_.push(*record);
        if (block && block->begins) {
            return false;
        }
        if (block) {
            last_at_ = block->at;
            block_.assign(block->bytes.begin(), block->bytes.end());
            played_ = 0;
            return true;
        }
    }
    return false;
}

// Reads until there is something to play. A second start without any bytes ends a loop that would
// bring none for ever.
void Playback::refill() {
    // A capture may take no time at all; playing it again must take some.
    constexpr std::chrono::nanoseconds shortest_loop = std::chrono::milliseconds(1);
    bool started_again = false;
    while (played_ == block_.size()) {
        if (read_block()) {
            continue;
        }
        block_.clear();
        played_ = 0;
        const auto length = std::max(last_at_ - descriptor_at_, shortest_loop);
        if (!loop_ || started_again || !rewind()) {
            return;
        }
        origin_ += length;
        started_again = true;
    }
}

void Playback::start(Moment now, std::uint32_t baud) {
    constexpr std::chrono::nanoseconds ten_bits = std::chrono::seconds(10);
    origin_ = now;
    byte_time_ = ten_bits / baud;
    if (rewind()) {
        refill();
    }
}

std::optional<Playback::Piece> Playback::piece() const {
    const auto left = std::span(block_).subspan(played_);
    if (left.empty()) {
        return std::nullopt;
    }
    // The time of a block is that of its last byte.
    const auto arrived = origin_ + (last_at_ - descriptor_at_);
    return Piece{
        .ready = arrived - byte_time_ * static_cast<std::int64_t>(left.size()),
        .bytes = left.first(std::min(left.size(), max_piece))};
}

void Playback::pop() {
    played_ += std::min(block_.size() - played_, max_piece);
    refill();
}

}  // namespace sweepcast::virtual_lidar
