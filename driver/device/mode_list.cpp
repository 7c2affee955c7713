#include "driver/device/mode_list.hpp"

#include "driver/device/ask.hpp"
#include "driver/protocol/error.hpp"
#include "driver/protocol/model.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using protocol::ConfType;

namespace {

/// No lidar known has more than six; a number beyond this is not believed.
constexpr std::uint16_t most_modes = 32;
/// What firmware before GET_SAMPLERATE is known to do (protocol.md 4.4).
constexpr protocol::SampleRate rate_of_old_firmware{476us, 476us};

template <class Value>
asio::awaitable<Result<Value>> ask_mode(
    Conversation& talk,
    ConfType type,
    std::uint16_t id,
    Result<Value> (*decode)(std::span<const std::uint8_t>)
) {
    return ask_conf<Value>(talk, type, protocol::get_mode_conf_request(type, id), decode);
}

/// Whether the line itself failed, so that asking on is pointless.
bool line_failed(const error_code& failure) {
    return failure.category() != protocol::protocol_category() && failure != errc::no_answer;
}

/// One mode; its answer type is what cannot be done without.
asio::awaitable<Result<ScanMode>> read_mode(Conversation& talk, std::uint16_t id) {
    const auto answer =
        co_await ask_mode(talk, ConfType::mode_answer_type, id, protocol::decode_mode_answer_type);
    if (!answer) {
        co_return answer.error();
    }
    const auto duration = co_await ask_mode(
        talk,
        ConfType::mode_sample_duration,
        id,
        protocol::decode_mode_sample_duration
    );
    if (!duration && line_failed(duration.error())) {
        co_return duration.error();
    }
    const auto distance = co_await ask_mode(
        talk,
        ConfType::mode_max_distance,
        id,
        protocol::decode_mode_max_distance
    );
    if (!distance && line_failed(distance.error())) {
        co_return distance.error();
    }
    const auto text = co_await ask_mode(talk, ConfType::mode_name, id, protocol::decode_conf_text);
    if (!text && line_failed(text.error())) {
        co_return text.error();
    }
    ScanMode mode{.name = {}, .answer_type = *answer, .sample_duration = {}, .id = id};
    mode.name = text && !text->empty() ? *text : "Mode " + std::to_string(id);
    mode.sample_duration = duration ? *duration : 0ns;
    mode.max_distance_mm = distance ? *distance : 0.0;
    co_return mode;
}

/// The modes that the lidar lists. Errors: conf_not_supported if it lists none; those of the link.
asio::awaitable<Result<std::vector<ScanMode>>> read_listed(Conversation& talk) {
    const auto count = co_await ask_conf<std::uint16_t>(
        talk,
        ConfType::scan_mode_count,
        protocol::get_conf_request(ConfType::scan_mode_count),
        protocol::decode_conf_u16
    );
    if (!count) {
        co_return count.error();
    }
    const auto typical = co_await ask_conf<std::uint16_t>(
        talk,
        ConfType::typical_mode,
        protocol::get_conf_request(ConfType::typical_mode),
        protocol::decode_conf_u16
    );
    if (!typical && line_failed(typical.error())) {
        co_return typical.error();
    }
    std::vector<ScanMode> modes;
    for (std::uint16_t id = 0; id < std::min(*count, most_modes); ++id) {
        auto mode = co_await read_mode(talk, id);
        if (!mode && line_failed(mode.error())) {
            co_return mode.error();
        }
        if (mode && protocol::packet_size(mode->answer_type) > 0) {
            mode->typical = typical && *typical == id;
            modes.push_back(std::move(*mode));
        }
    }
    if (modes.empty()) {
        co_return make_error_code(protocol::errc::conf_not_supported);
    }
    co_return modes;
}

}  // namespace

asio::awaitable<Result<std::vector<ScanMode>>>
read_modes(Conversation& talk, const protocol::DeviceInfo& info) {
    if (protocol::knows_lidar_conf(info)) {
        auto listed = co_await read_listed(talk);
        if (listed || line_failed(listed.error())) {
            co_return listed;
        }
    }
    auto rate = Result<protocol::SampleRate>(rate_of_old_firmware);
    if (protocol::knows_express(info)) {
        rate = co_await ask_for<protocol::SampleRate>(
            talk,
            {protocol::Command::get_sample_rate, {}},
            protocol::Expectation::sample_rate(),
            protocol::decode_sample_rate,
            patience_for_maybe
        );
    }
    if (!rate && line_failed(rate.error())) {
        co_return rate.error();
    }
    co_return legacy_modes(info, rate ? *rate : rate_of_old_firmware);
}

}  // namespace sweepcast::device
