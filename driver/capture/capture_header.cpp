// The header's JSON. Numbers are checked before they are narrowed: a capture may come from anybody.
#include "driver/capture/capture_header.hpp"

#include "driver/protocol/printable.hpp"

#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <boost/json/value.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>

namespace sweepcast::capture {

namespace json = boost::json;

namespace {

constexpr std::size_t longest_text = 256;
constexpr std::int64_t longest_sample_ns = 1'000'000'000;

Problem bad_header(std::string_view what) {
    return {
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("the header of the capture is damaged: {}", what),
        "capture anew; the bytes alone can be decoded with --type"};
}

std::string text_of(const json::object& object, std::string_view key) {
    const auto* value = object.if_contains(key);
    if (value == nullptr || !value->is_string()) {
        return {};
    }
    const std::string_view text = value->get_string();
    return protocol::printable_start(text, longest_text);
}

/// A whole number from 0 to `most`; nullopt if there is none or another.
std::optional<std::int64_t>
number_of(const json::object& object, std::string_view key, std::int64_t most) {
    const auto* value = object.if_contains(key);
    const auto* number = value != nullptr ? value->if_int64() : nullptr;
    return number != nullptr && *number >= 0 && *number <= most ? std::optional(*number)
                                                                : std::nullopt;
}

template <class T>
std::optional<T> number_of(const json::object& object, std::string_view key) {
    const auto number = number_of(object, key, std::numeric_limits<T>::max());
    return number ? std::optional(static_cast<T>(*number)) : std::nullopt;
}

}  // namespace

std::string to_json(const CaptureHeader& header) {
    json::object object;
    object["program"] = header.program;
    object["started"] = header.started;
    object["model"] = header.model;
    object["model_id"] = header.model_id;
    object["serial"] = header.serial;
    object["firmware"] = header.firmware;
    object["hardware"] = header.hardware;
    object["mode"] = header.mode;
    if (header.mode_id) {
        object["mode_id"] = *header.mode_id;
    }
    object["answer_type"] = static_cast<std::uint8_t>(header.answer_type);
    object["sample_ns"] = header.sample_duration.count();
    object["baud"] = header.baud;
    return json::serialize(object);
}

Result<CaptureHeader, Problem> header_from_json(std::string_view text) {
    boost::system::error_code bad;
    const auto value = json::parse(text, bad);
    if (bad || !value.is_object()) {
        return bad_header("it is no JSON object");
    }
    const auto& object = value.get_object();
    const auto answer_type = number_of<std::uint8_t>(object, "answer_type");
    if (!answer_type ||
        protocol::packet_size(static_cast<protocol::AnswerType>(*answer_type)) == 0) {
        return bad_header("\"answer_type\" is none that is known");
    }
    const auto sample_ns = number_of(object, "sample_ns", longest_sample_ns);
    if (!sample_ns) {
        return bad_header("\"sample_ns\" is no time between samples");
    }
    const auto baud = number_of<std::uint32_t>(object, "baud");
    if (!baud) {
        return bad_header("\"baud\" is no line speed");
    }
    CaptureHeader header;
    header.program = text_of(object, "program");
    header.started = text_of(object, "started");
    header.model = text_of(object, "model");
    header.model_id = number_of<std::uint8_t>(object, "model_id").value_or(0);
    header.serial = text_of(object, "serial");
    header.firmware = text_of(object, "firmware");
    header.hardware = number_of<std::uint8_t>(object, "hardware").value_or(0);
    header.mode = text_of(object, "mode");
    header.mode_id = number_of<std::uint16_t>(object, "mode_id");
    header.answer_type = static_cast<protocol::AnswerType>(*answer_type);
    header.sample_duration = std::chrono::nanoseconds(*sample_ns);
    header.baud = *baud;
    return header;
}

}  // namespace sweepcast::capture
