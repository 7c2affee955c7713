// Reads golden vectors from disk.
#include "tests/support/vector.hpp"

#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>
#include <boost/json/value_to.hpp>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>

namespace sweepcast::test {
namespace {

namespace json = boost::json;
using std::chrono::microseconds;

std::string read_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        throw std::runtime_error("cannot read " + path);
    }
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

protocol::Sample to_sample(const json::value& node) {
    return {
        .time = {},
        .distance = {node.at(1).to_number<std::uint32_t>()},
        .angle = {node.at(0).to_number<std::uint16_t>()},
        .quality = node.at(2).to_number<std::uint8_t>(),
        .flag = node.at(3).to_number<std::uint8_t>()};
}

protocol::DecodeEventKind to_event_kind(std::string_view name) {
    using enum protocol::DecodeEventKind;
    if (name == "checksum_error") {
        return checksum_error;
    }
    if (name == "encoder_reset") {
        return encoder_reset;
    }
    if (name == "scan_reset") {
        return scan_reset;
    }
    throw std::runtime_error("no such event: " + std::string(name));
}

VectorTiming to_timing(const json::value& timing, const protocol::DecodeSettings& settings) {
    VectorTiming result{
        .settings = settings,
        .chunk_bytes = timing.at("chunk_bytes").to_number<std::size_t>(),
        .first_chunk =
            protocol::SampleTime{microseconds{timing.at("t0_us").to_number<std::int64_t>()}},
        .between_chunks = microseconds{timing.at("dt_us").to_number<std::int64_t>()},
        .sample_times = {}};
    result.settings.baud = timing.at("baud").to_number<std::uint32_t>();
    result.settings.ethernet = timing.at("ethernet").to_number<int>() != 0;
    for (const auto& time : timing.at("node_ts_us").as_array()) {
        result.sample_times.emplace_back(microseconds{time.to_number<std::int64_t>()});
    }
    return result;
}

}  // namespace

std::string vector_path(const std::string& name) {
    return std::string(SWEEPCAST_VECTORS) + "/" + name + ".bin";
}

Vector load_vector(const std::string& name) {
    const auto bytes = read_file(vector_path(name));
    const auto text = json::parse(read_file(std::string(SWEEPCAST_VECTORS) + "/" + name + ".json"));

    Vector vector;
    vector.bytes.assign(bytes.begin(), bytes.end());
    const auto type = json::value_to<std::string>(text.at("answer_type"));
    vector.type = static_cast<protocol::AnswerType>(std::stoul(type, nullptr, 16));
    vector.settings.sample_duration =
        microseconds{text.at("sample_duration_us").to_number<std::int64_t>()};
    for (const auto& node : text.at("nodes").as_array()) {
        vector.expected.samples.push_back(to_sample(node));
    }
    for (const auto& event : text.at("events").as_array()) {
        vector.expected.events.push_back(
            {event.at("at_node").to_number<std::size_t>(),
             to_event_kind(event.at("kind").as_string())}
        );
    }
    if (const auto* timing = text.as_object().if_contains("timing")) {
        vector.timing = to_timing(*timing, vector.settings);
    }
    return vector;
}

}  // namespace sweepcast::test
