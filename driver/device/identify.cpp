#include "driver/device/identify.hpp"

#include "driver/device/error.hpp"
#include "driver/link/error.hpp"

#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;
using namespace std::chrono_literals;

namespace {

/// Answers come within milliseconds (protocol.md 11.4); this covers a slow adapter.
constexpr auto answer_limit = 500ms;
/// A second chance, for a line that a leftover of the last scan had garbled.
constexpr int attempts = 2;
/// What firmware before GET_SAMPLERATE is known to do (protocol.md 4.4).
constexpr protocol::SampleRate rate_of_old_firmware{476us, 476us};

/// Asks until there is an answer that decodes, at most `attempts` times.
template <class Reply>
asio::awaitable<Result<Reply>> ask_for(
    Conversation& conversation,
    protocol::Command command,
    protocol::Expectation expected,
    Result<Reply> (*decode)(std::span<const std::uint8_t>)
) {
    const protocol::Request request{command, {}};
    for (int attempt = 0; attempt < attempts; ++attempt) {
        const auto payload = co_await conversation.ask(request, expected, answer_limit);
        if (payload) {
            if (auto reply = decode(*payload)) {
                co_return reply;
            }
        } else if (payload.error() != link::errc::timed_out) {
            co_return payload.error();
        }
    }
    co_return make_error_code(errc::no_answer);
}

}  // namespace

asio::awaitable<Result<protocol::Health>> ask_health(Conversation& conversation) {
    co_return co_await ask_for<protocol::Health>(
        conversation,
        protocol::Command::get_health,
        protocol::Expectation::health(),
        protocol::decode_health
    );
}

asio::awaitable<Result<Identity>> identify(Conversation& conversation) {
    if (auto silent = co_await conversation.silence(); !silent) {
        co_return silent.error();
    }
    const auto info = co_await ask_for<protocol::DeviceInfo>(
        conversation,
        protocol::Command::get_info,
        protocol::Expectation::device_info(),
        protocol::decode_device_info
    );
    if (!info) {
        co_return info.error();
    }
    const auto health = co_await ask_health(conversation);
    if (!health) {
        co_return health.error();
    }
    auto rate = co_await ask_for<protocol::SampleRate>(
        conversation,
        protocol::Command::get_sample_rate,
        protocol::Expectation::sample_rate(),
        protocol::decode_sample_rate
    );
    if (!rate && rate.error() == errc::no_answer) {
        rate = rate_of_old_firmware;
    }
    if (!rate) {
        co_return rate.error();
    }
    co_return Identity{*info, *health, legacy_modes(*info, *rate)};
}

}  // namespace sweepcast::device
