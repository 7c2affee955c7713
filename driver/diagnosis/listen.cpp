#include "driver/diagnosis/listen.hpp"

#include "driver/device/conversation.hpp"
#include "driver/link/error.hpp"
#include "driver/protocol/request.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>
#include <vector>

namespace sweepcast::diagnosis {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using device::Conversation;

namespace {

/// As long as a scan takes to end (protocol.md 11.3).
constexpr auto drain_limit = 200ms;
constexpr auto drained_after = 20ms;
/// Answers come within milliseconds (protocol.md 11.4); the limit covers a slow adapter.
constexpr auto answer_limit = 500ms;
constexpr auto complete_after = 100ms;
/// Boot text is over, and the lidar answers, after this at the latest if its supply holds.
constexpr auto boot_limit = 3000ms;
/// A damaged answer is asked for again; two that are the same are believed.
constexpr int most_answers = 5;
/// More of a line than this tells nothing more.
constexpr std::size_t heard_at_most = std::size_t{16} * 1024;

/// When to stop collecting: at the limit, or once nothing has come for so long.
struct Until {
    Clock::duration limit;
    Clock::duration quiet;
    bool quiet_from_start;  ///< else from the first byte on
};

constexpr Until until_drained{drain_limit, drained_after, true};
constexpr Until until_answered{answer_limit, complete_after, false};

asio::awaitable<Result<std::vector<std::uint8_t>>>
collect(Conversation& talk, std::uint32_t baud, Until until) {
    std::vector<std::uint8_t> bytes;
    const auto give_up = Clock::now() + until.limit;
    while (bytes.size() < heard_at_most && Clock::now() < give_up) {
        const bool waits_for_first = bytes.empty() && !until.quiet_from_start;
        const auto quiet_at = Clock::now() + until.quiet;
        const auto got =
            co_await talk.read(waits_for_first ? give_up : std::min(quiet_at, give_up));
        if (!got && got.error() == link::errc::timed_out) {
            break;
        }
        if (!got) {
            co_return got.error();
        }
        bytes.insert(bytes.end(), got->begin(), got->end());
        if (!until.quiet_from_start && classify(baud, bytes).info) {
            break;  // a whole answer: nothing more is to come
        }
    }
    co_return bytes;
}

/// Sends a request and tells what comes then.
asio::awaitable<Result<Heard>>
ask_and_listen(Conversation& talk, protocol::Command command, Until until) {
    const auto baud = talk.link().baud();
    const protocol::Request request{command, {}};
    const auto sent = co_await talk.send(request);
    if (!sent) {
        co_return sent.error();
    }
    const auto bytes = co_await collect(talk, baud, until);
    if (!bytes) {
        co_return bytes.error();
    }
    co_return classify(baud, *bytes);
}

/// Adds what was heard later to what was heard before.
void add(Heard& all, Heard later) {
    const auto bytes = all.bytes + later.bytes;
    const auto boots = all.boots + later.boots;
    if (later.kind >= all.kind) {
        all = std::move(later);
    }
    all.bytes = bytes;
    all.boots = boots;
}

asio::awaitable<Result<Heard>> listen_at_present_speed(Conversation& talk) {
    auto heard = co_await ask_and_listen(talk, protocol::Command::stop, until_drained);
    const auto booted_by = Clock::now() + boot_limit;
    std::optional<protocol::DeviceInfo> before;
    for (int answers = 0; heard && answers < most_answers;) {
        auto answer = co_await ask_and_listen(talk, protocol::Command::get_info, until_answered);
        if (!answer) {
            co_return answer.error();
        }
        const auto kind = answer->kind;
        const auto info = std::exchange(answer->info, std::nullopt);
        add(*heard, std::move(*answer));
        if (info && info == before) {
            heard->info = info;
            break;
        }
        before = info ? info : before;
        const bool boots = kind == HeardKind::boot_text ||
                           (kind == HeardKind::nothing && heard->kind == HeardKind::boot_text);
        if (boots ? Clock::now() >= booted_by : kind == HeardKind::nothing) {
            break;
        }
        answers += boots ? 0 : 1;
    }
    co_return heard;
}

}  // namespace

asio::awaitable<Result<void>>
listen(link::Link& link, std::span<const std::uint32_t> bauds, LineLook& line) {
    Conversation talk(link);
    constexpr std::array<std::uint32_t, 1> no_speed{0};
    for (const auto baud : line.network ? std::span<const std::uint32_t>(no_speed) : bauds) {
        const auto set = line.network ? Result<void>{} : link.set_baud(baud);
        if (!set && set.error() == link::errc::baud_not_supported) {
            auto& unheard = line.heard.emplace_back();
            unheard.baud = baud;
            unheard.possible = false;
            continue;
        }
        if (!set) {
            co_return set;
        }
        auto heard = co_await listen_at_present_speed(talk);
        if (!heard) {
            co_return heard.error();
        }
        line.heard.push_back(std::move(*heard));
        if (line.heard.back().kind >= HeardKind::boot_text) {
            co_return Result<void>{};  // what can be read comes at the right speed
        }
    }
    const auto& best = line.best();
    co_return line.network || !best.possible ? Result<void>{} : link.set_baud(best.baud);
}

}  // namespace sweepcast::diagnosis
