#include "driver/device/motor.hpp"

#include "driver/link/error.hpp"
#include "driver/protocol/request.hpp"

#include <boost/asio/steady_timer.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <chrono>
#include <optional>

namespace sweepcast::device {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using protocol::MotorControl;

namespace {

/// Between switching the motor and the next request, as the vendor's SDK does (protocol.md 4.3).
constexpr auto motor_pause = 10ms;
constexpr std::uint16_t usual_pwm = 660;

Result<void> set_dtr(Conversation& talk, bool asserted) {
    const auto set = talk.link().set_dtr(asserted);
    const bool has_none = !set && set.error() == link::errc::no_modem_lines;
    return has_none ? Result<void>{} : set;
}

asio::awaitable<Result<void>> tell(Conversation& talk, const protocol::Request& request) {
    const auto sent = co_await talk.send(request);
    if (sent) {
        asio::steady_timer pause(co_await asio::this_coro::executor, motor_pause);
        co_await pause.async_wait(asio::use_awaitable);
    }
    co_return sent;
}

std::optional<protocol::Request> request_to(MotorControl control, std::uint16_t setting) {
    switch (control) {
    case MotorControl::modem_line:
    case MotorControl::accessory_board:
        return protocol::set_motor_pwm_request(setting);
    case MotorControl::rpm:
        return protocol::motor_rpm_request(setting);
    case MotorControl::self:
        break;
    }
    return std::nullopt;
}

}  // namespace

asio::awaitable<Result<void>>
run_motor(Conversation& talk, MotorControl control, std::uint16_t setting) {
    if (auto released = set_dtr(talk, false); !released) {
        co_return released;
    }
    const bool on_modem_line = control == MotorControl::modem_line;
    const auto request = request_to(control, on_modem_line ? usual_pwm : setting);
    if (!request) {
        co_return Result<void>{};
    }
    co_return co_await tell(talk, *request);
}

asio::awaitable<Result<void>> stop_motor(Conversation& talk, MotorControl control) {
    if (control == MotorControl::modem_line) {
        if (auto asserted = set_dtr(talk, true); !asserted) {
            co_return asserted;
        }
    }
    const auto request = request_to(control, 0);
    if (!request) {
        co_return Result<void>{};
    }
    co_return co_await tell(talk, *request);
}

}  // namespace sweepcast::device
