// Configuration requests -> bytes, answers -> values.
#include "driver/protocol/lidar_conf.hpp"

#include "driver/protocol/error.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>

namespace sweepcast::protocol {
namespace {

constexpr std::size_t type_size = 4;
constexpr std::size_t longest_text = 64;

Request conf_request(Command command, ConfType type, std::span<const std::uint8_t> rest) {
    Request request{command, std::vector<std::uint8_t>(type_size + rest.size())};
    store_le32(std::span(request.payload).first<type_size>(), static_cast<std::uint32_t>(type));
    std::copy(rest.begin(), rest.end(), request.payload.begin() + type_size);
    return request;
}

/// What follows the echoed type.
Result<std::span<const std::uint8_t>>
after_type(std::span<const std::uint8_t> packet, ConfType asked) {
    if (packet.size() < type_size) {
        return make_error_code(errc::length_out_of_range);
    }
    if (load_le32(packet.first<type_size>()) != static_cast<std::uint32_t>(asked)) {
        return make_error_code(errc::conf_type_mismatch);
    }
    return packet.subspan(type_size);
}

}  // namespace

Request get_conf_request(ConfType type, std::span<const std::uint8_t> arguments) {
    return conf_request(Command::get_lidar_conf, type, arguments);
}

Request get_mode_conf_request(ConfType type, std::uint16_t mode) {
    std::array<std::uint8_t, 2> argument{};
    store_le16(argument, mode);
    return get_conf_request(type, argument);
}

Request set_conf_request(ConfType type, std::span<const std::uint8_t> value) {
    return conf_request(Command::set_lidar_conf, type, value);
}

Result<std::span<const std::uint8_t>>
decode_conf(std::span<const std::uint8_t> packet, ConfType asked) {
    const auto value = after_type(packet, asked);
    if (value && value->empty()) {
        return make_error_code(errc::conf_not_supported);
    }
    return value;
}

Result<void> decode_set_conf(std::span<const std::uint8_t> packet, ConfType asked) {
    const auto result = after_type(packet, asked);
    if (!result) {
        return result.error();
    }
    if (result->size() < 4) {
        return make_error_code(errc::length_out_of_range);
    }
    if (load_le32(result->first<4>()) != 0) {
        return make_error_code(errc::conf_refused);
    }
    return {};
}

Result<std::uint16_t> decode_conf_u16(std::span<const std::uint8_t> value) {
    if (value.size() < 2) {
        return make_error_code(errc::length_out_of_range);
    }
    return load_le16(value.first<2>());
}

Result<DesiredRotation> decode_desired_rotation(std::span<const std::uint8_t> value) {
    if (value.size() < 4) {
        return make_error_code(errc::length_out_of_range);
    }
    return DesiredRotation{load_le16(value.first<2>()), load_le16(value.subspan<2, 2>())};
}

Result<StaticIp> decode_static_ip(std::span<const std::uint8_t> value) {
    constexpr std::size_t size = 12;
    if (value.size() < size) {
        return make_error_code(errc::length_out_of_range);
    }
    StaticIp ip;
    std::copy_n(value.begin(), 4, ip.address.begin());
    std::copy_n(value.begin() + 4, 4, ip.netmask.begin());
    std::copy_n(value.begin() + 8, 4, ip.gateway.begin());
    return ip;
}

std::vector<std::uint8_t> encode_static_ip(const StaticIp& address) {
    std::vector<std::uint8_t> value;
    for (const auto& part : {address.address, address.netmask, address.gateway}) {
        value.insert(value.end(), part.begin(), part.end());
    }
    return value;
}

Result<std::chrono::nanoseconds> decode_mode_sample_duration(std::span<const std::uint8_t> value) {
    if (value.size() < 4) {
        return make_error_code(errc::length_out_of_range);
    }
    return std::chrono::nanoseconds{std::uint64_t{load_le32(value.first<4>())} * 1000 / 256};
}

Result<double> decode_mode_max_distance(std::span<const std::uint8_t> value) {
    if (value.size() < 4) {
        return make_error_code(errc::length_out_of_range);
    }
    return load_le32(value.first<4>()) * (1000.0 / 256.0);
}

Result<AnswerType> decode_mode_answer_type(std::span<const std::uint8_t> value) {
    if (value.empty()) {
        return make_error_code(errc::length_out_of_range);
    }
    return static_cast<AnswerType>(value[0]);
}

Result<std::string> decode_conf_text(std::span<const std::uint8_t> value) {
    std::string text;
    for (const auto byte : value.first(std::min(value.size(), longest_text))) {
        if (byte == 0) {
            break;
        }
        if (byte >= ' ' && byte <= '~') {
            text += static_cast<char>(byte);
        }
    }
    return text;
}

}  // namespace sweepcast::protocol
