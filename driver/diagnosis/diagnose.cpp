#include "driver/diagnosis/diagnose.hpp"

#include "driver/device/conversation.hpp"
#include "driver/device/find_baud.hpp"
#include "driver/device/identify.hpp"
#include "driver/device/mode_list.hpp"
#include "driver/diagnosis/answer_findings.hpp"
#include "driver/diagnosis/listen.hpp"
#include "driver/diagnosis/port_findings.hpp"
#include "driver/diagnosis/scan_findings.hpp"
#include "driver/diagnosis/try_scan.hpp"
#include "driver/link/open_link.hpp"
#include "driver/protocol/model.hpp"

#include <boost/asio/error.hpp>
#include <boost/system/system_error.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

namespace sweepcast::diagnosis {

namespace asio = boost::asio;
using device::Conversation;
using LinkPtr = std::unique_ptr<link::Link>;

namespace {

/// A read that was interrupted: nobody but a cancellation does that here.
void throw_if_cancelled(const error_code& failure) {
    if (failure == link::errc::interrupted) {
        throw boost::system::system_error(asio::error::operation_aborted);
    }
}

/// One walk along the chain.
class Walk {
public:
    Walk(
        asio::any_io_executor executor,
        link::LinkUrl url,
        std::vector<std::uint32_t> baud_hints,
        OnCheck on_check
    )
        : executor_(std::move(executor))
        , url_(std::move(url))
        , serial_(std::get_if<link::SerialPlace>(&url_.where))
        , builder_(url_.text, std::move(on_check)) {
        if (serial_ != nullptr && serial_->baud) {
            line_.asked_baud = serial_->baud;
            baud_hints.insert(baud_hints.begin(), *serial_->baud);
        }
        bauds_ = device::bauds_to_try(baud_hints);
        line_.url = serial_ != nullptr ? serial_->path : url_.text;
        line_.network = serial_ == nullptr;
    }
    Walk(const Walk&) = delete;
    Walk& operator=(const Walk&) = delete;

    asio::awaitable<Diagnosis> run() {
        auto link = co_await open();
        if (link) {
            const auto setup = co_await meet(*link);
            if (setup) {
                co_await scan(std::move(link), *setup);
            }
        }
        co_return builder_.finish();
    }

private:
    asio::awaitable<LinkPtr> open();
    asio::awaitable<LinkPtr> open_port();
    asio::awaitable<std::optional<ScanSetup>> meet(link::Link& link);
    asio::awaitable<void> scan(LinkPtr link, ScanSetup setup);
    asio::awaitable<Result<LinkPtr, Problem>> open_at_a_speed();

    asio::any_io_executor executor_;
    link::LinkUrl url_;
    const link::SerialPlace* serial_;
    std::vector<std::uint32_t> bauds_;
    DiagnosisBuilder builder_;
    LineLook line_;
};

/// The open link, or nothing if a check failed.
asio::awaitable<LinkPtr> Walk::open() {
    if (serial_ != nullptr) {
        co_return co_await open_port();
    }
    auto link = co_await link::open_link(executor_, url_, 0);
    if (!link) {
        builder_.add(judge_failed_connection(url_.text, link.error()));
        co_return nullptr;
    }
    builder_.add({Step::open, Verdict::ok, "connected"});
    co_return std::move(*link);
}

asio::awaitable<LinkPtr> Walk::open_port() {
    PortLook look;
    look.path = serial_->path;
    look.error = link::find_open_obstacle(look.path);
    look.facts = co_await link::look_up_port_facts(look.path);
    std::vector<Finding> findings{
        judge_port(look),
        judge_permission(look),
        judge_holder(look, false)};
    LinkPtr opened;
    if (std::ranges::all_of(findings, [](const auto& each) {
            return each.verdict == Verdict::ok;
        })) {
        auto link = co_await open_at_a_speed();
        if (link) {
            opened = std::move(*link);
            findings.push_back({Step::open, Verdict::ok, "8N1, raw, for us alone"});
        } else {
            // Only trying shows what the device rules of a container or another user's lock forbid.
            look.facts = co_await link::look_up_port_facts(look.path);
            auto finding = judge_failed_opening(look, link.error());
            std::erase_if(findings, [&](const auto& each) { return each.step >= finding.step; });
            findings.push_back(std::move(finding));
        }
    }
    for (auto& finding : findings) {
        if (!builder_.add(std::move(finding))) {
            co_return nullptr;
        }
    }
    if (const auto* adapter = look.adapter()) {
        line_.adapter = *adapter;
    }
    co_return opened;
}

/// Opens the port at the first speed that its adapter can run at; only at the one asked for, if so.
asio::awaitable<Result<LinkPtr, Problem>> Walk::open_at_a_speed() {
    auto link = co_await link::open_link(executor_, url_, bauds_.front());
    for (std::size_t i = 1; i < bauds_.size() && !line_.asked_baud; ++i) {
        if (link || link.error().code != link::errc::baud_not_supported) {
            break;
        }
        link = co_await link::open_link(executor_, url_, bauds_[i]);
    }
    co_return link;
}

/// Listens, and asks the lidar who and how it is and what it can do. Nothing if a check failed.
asio::awaitable<std::optional<ScanSetup>> Walk::meet(link::Link& link) {
    const auto listened = co_await listen(link, bauds_, line_);
    if (!listened) {
        throw_if_cancelled(listened.error());
        builder_.add(judge_broken_line(line_, listened.error()));
        co_return std::nullopt;
    }
    const auto info = line_.best().info;
    if (!builder_.add(judge_bytes(line_)) || !builder_.add(judge_descriptor(line_)) ||
        !builder_.add(judge_info(info, "")) || !info) {
        co_return std::nullopt;
    }
    Conversation talk(link);
    const auto health = co_await device::ask_health(talk);
    if (!health) {
        throw_if_cancelled(health.error());
    }
    if (!builder_.add(judge_health(health))) {
        co_return std::nullopt;
    }
    device::Identity identity{*info, *health, {}, {}, {}};
    auto modes = co_await device::read_modes(talk, *info);
    if (modes && !modes->empty()) {
        identity.modes = *modes;
        const auto detailed = co_await device::ask_details(talk, identity);
        if (!detailed) {
            modes = detailed.error();
        }
    }
    if (!modes) {
        throw_if_cancelled(modes.error());
    }
    if (!builder_.add(judge_modes(modes))) {
        co_return std::nullopt;
    }
    const auto* mode = device::best_mode(identity.modes);
    co_return ScanSetup{device::shown_name(identity), identity.motor, *mode};
}

asio::awaitable<void> Walk::scan(LinkPtr link, ScanSetup setup) {
    auto trial = co_await try_scan(std::move(link), std::move(setup));
    trial.quality.adapter = line_.adapter;
    if (builder_.add(judge_motor(trial.spin)) && builder_.add(judge_sweep(trial.sweep)) &&
        builder_.add(judge_quality(trial.quality))) {
        builder_.add(judge_speed(trial.rotation));
    }
}

}  // namespace

asio::awaitable<Diagnosis> diagnose(
    asio::any_io_executor executor,
    link::LinkUrl url,
    std::vector<std::uint32_t> baud_hints,
    OnCheck on_check
) {
    Walk walk(std::move(executor), std::move(url), std::move(baud_hints), std::move(on_check));
    co_return co_await walk.run();
}

}  // namespace sweepcast::diagnosis
