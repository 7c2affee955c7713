// Any bytes as the packet of a reply: it is refused, or read and written back to the same bytes.
// The first byte chooses the reply.
#include "driver/protocol/lidar_conf.hpp"
#include "driver/protocol/reply.hpp"
#include "tests/fuzz/fuzzing.hpp"

#include <algorithm>
#include <array>

namespace sweepcast::fuzz {
namespace {

using namespace protocol;

/// What can be read can be written; the first bytes come back.
template <class Value, std::size_t Size>
void require_round_trip(
    Input packet,
    const Result<Value>& decoded,
    std::array<std::uint8_t, Size> (*encode)(const Value&)
) {
    if (!decoded) {
        return;
    }
    const auto encoded = encode(*decoded);
    require(packet.size() >= Size);
    require(std::equal(encoded.begin(), encoded.end(), packet.begin()));
}

void read_board(Input packet) {
    if (const auto board = decode_acc_board_flag(packet)) {
        require(board->controls_motor == ((packet[0] & 1U) != 0));
        require(decode_acc_board_flag(encode_acc_board_flag(*board)).value() == *board);
    }
}

void read_text(Input value) {
    const auto text = decode_conf_text(value).value();
    require(text.size() <= std::min<std::size_t>(value.size(), 64));
    require(std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; }));
}

void read_conf(Input packet) {
    constexpr std::array types{
        ConfType::desired_rotation,
        ConfType::scan_mode_count,
        ConfType::mode_sample_duration,
        ConfType::mode_max_distance,
        ConfType::mode_answer_type,
        ConfType::mac_address,
        ConfType::mode_name,
        ConfType::static_ip};
    for (const auto type : types) {
        const auto value = decode_conf(packet, type);
        if (!value) {
            continue;
        }
        require(!value->empty() && value->size() == packet.size() - 4);
        static_cast<void>(decode_conf_u16(*value));
        static_cast<void>(decode_desired_rotation(*value));
        static_cast<void>(decode_mode_answer_type(*value));
        if (const auto duration = decode_mode_sample_duration(*value)) {
            require(duration->count() >= 0);
        }
        if (const auto distance = decode_mode_max_distance(*value)) {
            require(*distance >= 0);
        }
        if (const auto address = decode_static_ip(*value)) {
            const auto encoded = encode_static_ip(*address);
            require(std::equal(encoded.begin(), encoded.end(), value->begin()));
        }
        read_text(*value);
    }
    static_cast<void>(decode_set_conf(packet, ConfType::static_ip));
}

}  // namespace
}  // namespace sweepcast::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace sweepcast::fuzz;
    Input input{data, size};
    switch (take_byte(input) % 6) {
    case 0:
        require_round_trip(input, decode_device_info(input), encode_device_info);
        break;
    case 1:
        require_round_trip(input, decode_health(input), encode_health);
        break;
    case 2:
        require_round_trip(input, decode_sample_rate(input), encode_sample_rate);
        break;
    case 3:
        read_board(input);
        break;
    case 4:
        read_conf(input);
        break;
    default:
        read_text(input);
        break;
    }
    return 0;
}
