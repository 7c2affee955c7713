#include "driver/device/static_ip.hpp"

#include "driver/device/ask.hpp"

#include <array>

namespace sweepcast::device {

namespace asio = boost::asio;
using protocol::ConfType;

namespace {

Result<void> decode_set(std::span<const std::uint8_t> packet) {
    return protocol::decode_set_conf(packet, ConfType::static_ip);
}

}  // namespace

asio::awaitable<Result<protocol::StaticIp>> read_static_ip(Conversation& talk) {
    constexpr std::array<std::uint8_t, 2> reserved{};
    co_return co_await ask_conf<protocol::StaticIp>(
        talk,
        ConfType::static_ip,
        protocol::get_conf_request(ConfType::static_ip, reserved),
        protocol::decode_static_ip
    );
}

asio::awaitable<Result<void>> set_static_ip(Conversation& talk, const protocol::StaticIp& address) {
    co_return co_await ask_for<void>(
        talk,
        protocol::set_conf_request(ConfType::static_ip, protocol::encode_static_ip(address)),
        protocol::Expectation::set_lidar_conf(),
        decode_set
    );
}

}  // namespace sweepcast::device
