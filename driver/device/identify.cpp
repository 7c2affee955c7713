#include "driver/device/identify.hpp"

#include "driver/device/ask.hpp"
#include "driver/device/mode_list.hpp"
#include "driver/protocol/error.hpp"

#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;
using protocol::ConfType;

namespace {

/// A configuration value that is the same for all modes; nothing if the lidar does not know it.
/// Errors: those of the link.
template <class Value>
asio::awaitable<Result<std::optional<Value>>> ask_optional(
    Conversation& talk,
    ConfType type,
    Result<Value> (*decode)(std::span<const std::uint8_t>)
) {
    auto value = co_await ask_conf<Value>(talk, type, protocol::get_conf_request(type), decode);
    if (value) {
        co_return std::optional<Value>(std::move(*value));
    }
    if (value.error().category() == protocol::protocol_category()) {
        co_return std::optional<Value>();
    }
    co_return value.error();
}

/// What turns the motor: of models that may have an accessory board only the board itself knows.
asio::awaitable<Result<protocol::MotorControl>>
ask_motor_control(Conversation& talk, const protocol::DeviceInfo& info) {
    const auto usual = protocol::motor_control_of(info.model);
    if (usual != protocol::MotorControl::accessory_board) {
        co_return usual;
    }
    const auto board = co_await ask_for<protocol::AccessoryBoard>(
        talk,
        protocol::acc_board_flag_request(),
        protocol::Expectation::acc_board_flag(),
        protocol::decode_acc_board_flag,
        patience_for_maybe
    );
    if (!board && board.error() != errc::no_answer) {
        co_return board.error();
    }
    co_return board && board->controls_motor ? usual : protocol::MotorControl::modem_line;
}

/// The speeds that the lidar is made for. Zeros, which would stop a motor, are not believed.
asio::awaitable<Result<MotorTraits>> ask_rotation(Conversation& talk, MotorTraits traits) {
    const auto desired = co_await ask_optional<protocol::DesiredRotation>(
        talk,
        ConfType::desired_rotation,
        protocol::decode_desired_rotation
    );
    if (!desired) {
        co_return desired.error();
    }
    const auto least = co_await ask_optional<std::uint16_t>(
        talk,
        ConfType::min_rotation,
        protocol::decode_conf_u16
    );
    if (!least) {
        co_return least.error();
    }
    const auto most = co_await ask_optional<std::uint16_t>(
        talk,
        ConfType::max_rotation,
        protocol::decode_conf_u16
    );
    if (!most) {
        co_return most.error();
    }
    if (*desired && (*desired)->rpm > 0) {
        traits.desired.rpm = (*desired)->rpm;
    }
    if (*desired && (*desired)->pwm > 0) {
        traits.desired.pwm = (*desired)->pwm;
    }
    if (*least && *most && **least < **most) {
        traits.min_rpm = **least;
        traits.max_rpm = **most;
    }
    co_return traits;
}

}  // namespace

asio::awaitable<Result<protocol::DeviceInfo>> ask_info(Conversation& talk, Patience patience) {
    const auto silent = co_await talk.silence();
    if (!silent) {
        co_return silent.error();
    }
    co_return co_await ask_for<protocol::DeviceInfo>(
        talk,
        {protocol::Command::get_info, {}},
        protocol::Expectation::device_info(),
        protocol::decode_device_info,
        patience
    );
}

asio::awaitable<Result<protocol::Health>> ask_health(Conversation& talk) {
    co_return co_await ask_for<protocol::Health>(
        talk,
        {protocol::Command::get_health, {}},
        protocol::Expectation::health(),
        protocol::decode_health
    );
}

asio::awaitable<Result<Identity>> identify(Conversation& talk) {
    const auto info = co_await ask_info(talk);
    if (!info) {
        co_return info.error();
    }
    const auto health = co_await ask_health(talk);
    if (!health) {
        co_return health.error();
    }
    auto modes = co_await read_modes(talk, *info);
    if (!modes) {
        co_return modes.error();
    }
    Identity identity{*info, *health, std::move(*modes), {}, {}};
    const auto detailed = co_await ask_details(talk, identity);
    if (!detailed) {
        co_return detailed.error();
    }
    co_return identity;
}

asio::awaitable<Result<void>> ask_details(Conversation& talk, Identity& identity) {
    const auto control = co_await ask_motor_control(talk, identity.info);
    if (!control) {
        co_return control.error();
    }
    identity.motor.control = *control;
    if (!protocol::knows_lidar_conf(identity.info) || !identity.modes.front().id) {
        co_return Result<void>{};
    }
    const auto alias =
        co_await ask_optional<std::string>(talk, ConfType::model_alias, protocol::decode_conf_text);
    if (!alias) {
        co_return alias.error();
    }
    identity.alias = alias->value_or("");
    const auto motor = co_await ask_rotation(talk, identity.motor);
    if (!motor) {
        co_return motor.error();
    }
    identity.motor = *motor;
    co_return Result<void>{};
}

std::string shown_name(const Identity& identity) {
    return identity.alias.empty() ? protocol::model_name(identity.info.model) : identity.alias;
}

}  // namespace sweepcast::device
