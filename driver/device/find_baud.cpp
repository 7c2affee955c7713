#include "driver/device/find_baud.hpp"

#include "driver/device/ask.hpp"
#include "driver/device/error.hpp"
#include "driver/device/identify.hpp"
#include "driver/link/error.hpp"
#include "driver/protocol/error.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>
#include <array>
#include <chrono>

namespace sweepcast::device {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

/// At a wrong speed no answer is the rule; the second attempt is for a lidar that was still deaf.
constexpr Patience patience_at_a_speed{250ms, 2};
/// Where it was met before: it may be booting, and answers as soon as it can.
constexpr Patience patience_where_met{250ms, 6};
/// Blocks of the measuring byte are sent for so long at most (protocol.md 4.7).
constexpr auto measuring_limit = 1500ms;
constexpr auto measured_limit = 500ms;
constexpr std::size_t block_size = 16;

bool is_silence(const error_code& failure) {
    return failure == errc::no_answer || failure.category() == protocol::protocol_category();
}

/// Sends what the lidar measures the speed by until it says what it measured; 0 if it does not.
asio::awaitable<Result<std::uint32_t>> let_it_measure(Conversation& talk) {
    std::array<std::uint8_t, block_size> block{};
    block.fill(protocol::autobaud_byte);
    std::vector<std::uint8_t> answer;
    const auto give_up = Clock::now() + measuring_limit;
    while (answer.empty() && Clock::now() < give_up) {
        const auto sent = co_await talk.write(block);
        if (!sent) {
            co_return sent.error();
        }
        const auto heard = co_await talk.read(Clock::now() + 10ms);
        if (!heard && heard.error() != link::errc::timed_out) {
            co_return heard.error();
        }
        if (heard) {
            answer.assign(heard->begin(), heard->end());
        }
    }
    const auto complete_by = Clock::now() + measured_limit;
    while (!answer.empty() && answer.size() < 4) {
        const auto heard = co_await talk.read(complete_by);
        if (!heard && heard.error() != link::errc::timed_out) {
            co_return heard.error();
        }
        if (!heard) {
            co_return 0U;
        }
        answer.insert(answer.end(), heard->begin(), heard->end());
    }
    co_return answer.empty() ? 0U : protocol::load_le32(std::span(answer).first<4>());
}

/// Whether what the lidar measured is what was sent, within 5 % (protocol.md 4.7).
bool measured_right(std::uint32_t measured, std::uint32_t baud) {
    const auto difference = measured > baud ? measured - baud : baud - measured;
    return std::uint64_t{difference} * 20 <= baud;
}

}  // namespace

std::vector<std::uint32_t> bauds_to_try(std::span<const std::uint32_t> hints) {
    std::vector<std::uint32_t> bauds;
    const auto add = [&bauds](std::uint32_t baud) {
        if (baud > 0 && std::ranges::find(bauds, baud) == bauds.end()) {
            bauds.push_back(baud);
        }
    };
    std::ranges::for_each(hints, add);
    std::ranges::for_each(usual_bauds, add);
    return bauds;
}

asio::awaitable<Result<Found>>
find_baud(Conversation& talk, std::span<const std::uint32_t> bauds, bool met_before) {
    if (talk.link().is_network()) {
        const auto info = co_await ask_info(talk, patience_at_a_speed);
        if (!info) {
            co_return info.error();
        }
        co_return Found{0, *info};
    }
    auto failure = make_error_code(link::errc::baud_not_supported);
    for (const auto baud : bauds) {
        auto set = talk.link().set_baud(baud);
        if (!set && set.error() == link::errc::baud_not_supported) {
            continue;  // not every adapter can run at every speed
        }
        if (!set) {
            co_return set.error();
        }
        const bool here = met_before && baud == bauds.front();
        const auto info = co_await ask_info(talk, here ? patience_where_met : patience_at_a_speed);
        if (info) {
            co_return Found{baud, *info};
        }
        if (!is_silence(info.error())) {
            co_return info.error();
        }
        failure = make_error_code(errc::no_answer);
    }
    co_return failure;
}

asio::awaitable<Result<void>> negotiate_baud(Conversation& talk, std::uint32_t baud) {
    const auto before = talk.link().baud();
    const auto silent = co_await talk.silence();
    if (!silent) {
        co_return silent;
    }
    if (auto set = talk.link().set_baud(baud); !set) {
        co_return set;
    }
    const auto measured = co_await let_it_measure(talk);
    if (!measured) {
        co_return measured.error();
    }
    if (measured_right(*measured, baud)) {
        const auto confirmed = co_await talk.send(protocol::confirm_baud_request(baud));
        if (!confirmed) {
            co_return confirmed;
        }
        const auto info = co_await ask_info(talk);
        if (info) {
            co_return Result<void>{};
        }
        if (!is_silence(info.error())) {
            co_return info.error();
        }
    }
    if (auto set = talk.link().set_baud(before); !set) {
        co_return set;
    }
    co_return make_error_code(errc::baud_refused);
}

}  // namespace sweepcast::device
