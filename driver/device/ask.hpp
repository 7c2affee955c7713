// ask_for: one question to a lidar, asked again if the answer does not come or cannot be read.
#pragma once

#include "driver/device/conversation.hpp"
#include "driver/device/error.hpp"
#include "driver/link/error.hpp"
#include "driver/protocol/error.hpp"
#include "driver/protocol/lidar_conf.hpp"

#include <boost/asio/awaitable.hpp>

#include <chrono>
#include <span>

namespace sweepcast::device {

/// How long to wait for an answer, and how often to ask.
struct Patience {
    std::chrono::milliseconds limit{500};
    int attempts{2};
};

/// For what every lidar knows. Answers come within milliseconds (protocol.md 11.4), so the limit
/// covers a slow adapter; the second attempt is for a line that leftovers of a scan had garbled.
inline constexpr Patience patience_for_answers{};
/// For what a lidar may not know, and then does not answer at all (protocol.md 13.16).
inline constexpr Patience patience_for_maybe{std::chrono::milliseconds{250}, 2};

/// Asks until there is an answer that `decode` can read.
/// Errors: errc::no_answer if none came; what `decode` said of the last one; those of the link.
template <class Reply>
boost::asio::awaitable<Result<Reply>> ask_for(
    Conversation& talk,
    protocol::Request request,
    protocol::Expectation expected,
    Result<Reply> (*decode)(std::span<const std::uint8_t>),
    Patience patience = patience_for_answers
) {
    error_code failure = make_error_code(errc::no_answer);
    for (int attempt = 0; attempt < patience.attempts; ++attempt) {
        const auto payload = co_await talk.ask(request, expected, patience.limit);
        if (payload) {
            auto reply = decode(*payload);
            if (reply) {
                co_return reply;
            }
            failure = reply.error();
        } else if (payload.error() != link::errc::timed_out) {
            co_return payload.error();
        }
    }
    co_return failure;
}

/// Asks for a configuration value: `request` for `type`.
/// Errors: protocol::errc::conf_not_supported if the lidar does not know it, by its own word or by
/// silence; as ask_for().
template <class Value>
boost::asio::awaitable<Result<Value>> ask_conf(
    Conversation& talk,
    protocol::ConfType type,
    protocol::Request request,
    Result<Value> (*decode)(std::span<const std::uint8_t>),
    Patience patience = patience_for_maybe
) {
    error_code failure = make_error_code(protocol::errc::conf_not_supported);
    for (int attempt = 0; attempt < patience.attempts; ++attempt) {
        const auto packet =
            co_await talk.ask(request, protocol::Expectation::lidar_conf(), patience.limit);
        if (!packet && packet.error() != link::errc::timed_out) {
            co_return packet.error();
        }
        if (!packet) {
            continue;
        }
        const auto value = protocol::decode_conf(*packet, type);
        if (value) {
            co_return decode(*value);
        }
        failure = value.error();
        if (failure == protocol::errc::conf_not_supported) {
            break;
        }
    }
    co_return failure;
}

}  // namespace sweepcast::device
