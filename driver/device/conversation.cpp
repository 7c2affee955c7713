#include "driver/device/conversation.hpp"

#include "driver/link/error.hpp"

#include <utility>

namespace sweepcast::device {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

/// A request has at most 260 bytes: 23 ms at the slowest line speed.
constexpr auto send_limit = 500ms;
constexpr auto quiet_time = 20ms;
constexpr auto drain_limit = 200ms;

}  // namespace

asio::awaitable<Result<void>> Conversation::write(std::span<const std::uint8_t> bytes) {
    co_return co_await link_.write_all(bytes, Clock::now() + send_limit);
}

asio::awaitable<Result<void>> Conversation::send(const protocol::Request& request) {
    const auto bytes = protocol::encode(request);
    co_return co_await write(bytes);
}

asio::awaitable<Result<void>> Conversation::silence() {
    const protocol::Request stop{protocol::Command::stop, {}};
    if (auto sent = co_await send(stop); !sent) {
        co_return sent;
    }
    unread_ = {};
    const auto give_up = Clock::now() + drain_limit;
    while (Clock::now() < give_up) {  // a source that never pauses must not hold us here
        const auto quiet_at = Clock::now() + quiet_time;
        const auto got = co_await link_.read_some(buffer_, std::min(quiet_at, give_up));
        if (got.has_error() && got.error() == link::errc::timed_out) {
            co_return Result<void>{};
        }
        if (got.has_error()) {
            co_return got.error();
        }
    }
    co_return Result<void>{};
}

asio::awaitable<Result<std::vector<std::uint8_t>>> Conversation::ask(
    const protocol::Request& request,
    const protocol::Expectation& expected,
    std::chrono::milliseconds limit
) {
    const auto deadline = Clock::now() + limit;
    unread_ = {};
    if (auto sent = co_await send(request); !sent) {
        co_return sent.error();
    }
    const auto descriptor = co_await hunt(expected, deadline);
    if (!descriptor) {
        co_return descriptor.error();
    }
    std::vector<std::uint8_t> payload;
    payload.reserve(descriptor->length);  // the hunt accepts no length beyond the expected
    while (payload.size() < descriptor->length) {
        const auto bytes = co_await read(deadline);
        if (!bytes) {
            co_return bytes.error();
        }
        const auto wanted = std::min(bytes->size(), descriptor->length - payload.size());
        payload.insert(
            payload.end(),
            bytes->begin(),
            bytes->begin() + static_cast<std::ptrdiff_t>(wanted)
        );
        keep(bytes->subspan(wanted));
    }
    co_return payload;
}

asio::awaitable<Result<protocol::Descriptor>>
Conversation::open_stream(const protocol::Request& request, std::chrono::milliseconds limit) {
    const auto deadline = Clock::now() + limit;
    unread_ = {};
    if (auto sent = co_await send(request); !sent) {
        co_return sent.error();
    }
    co_return co_await hunt(protocol::Expectation::measurement(), deadline);
}

asio::awaitable<Result<std::span<const std::uint8_t>>> Conversation::read(Clock::time_point deadline
) {
    if (!unread_.empty()) {
        co_return std::exchange(unread_, {});
    }
    const auto got = co_await link_.read_some(buffer_, deadline);
    if (!got) {
        co_return got.error();
    }
    co_return std::span<const std::uint8_t>(buffer_).first(*got);
}

asio::awaitable<Result<protocol::Descriptor>>
Conversation::hunt(const protocol::Expectation& expected, Clock::time_point deadline) {
    protocol::DescriptorHunter hunter(expected);
    for (;;) {
        const auto bytes = co_await read(deadline);
        if (!bytes) {
            co_return bytes.error();
        }
        const auto step = hunter.push(*bytes);
        if (step.found) {
            keep(bytes->subspan(step.consumed));
            co_return *step.found;
        }
        if (Clock::now() >= deadline) {  // bytes without end are no answer either
            co_return make_error_code(link::errc::timed_out);
        }
    }
}

}  // namespace sweepcast::device
