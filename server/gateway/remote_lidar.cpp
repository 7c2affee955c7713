#include "server/gateway/remote_lidar.hpp"

#include "server/hub/named_lidar.hpp"
#include "server/stream/lidar_message.hpp"
#include "server/stream/messages.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace sweepcast::gateway {

namespace asio = boost::asio;
using namespace std::chrono_literals;

namespace {

/// Gateways one behind the other. More are a loop, most likely: each round
/// makes the URL longer.
constexpr std::size_t most_hops = 4;
constexpr std::string_view via = " via ";
constexpr double sector_deg = 30;
/// How many bytes of ids a hint lists.
constexpr std::size_t enough_ids = 200;

client::ClientOptions states_first() {
    client::ClientOptions options;
    options.wish.reset();  // set when it is known which lidar there it is
    return options;
}

std::size_t hops(std::string_view url) {
    std::size_t count = 0;
    for (auto at = url.find(via); at != std::string_view::npos; at = url.find(via, at + 1)) {
        ++count;
    }
    return count;
}

/// Returns the names by which a lidar's own gateway finds it, as far as the state tells them.
hub::LidarNames names_there(const v1::Lidar& lidar) {
    const std::string_view url = lidar.url();
    const auto last = url.rfind(via);
    const auto place =
        parse_lidar_url(last == std::string_view::npos ? url : url.substr(last + via.size()));
    return {lidar.id(), lidar.device().serial_number(), place ? port_name(*place) : std::string()};
}

v1::Subscribe wish_for(const v1::Lidar& lidar) {
    v1::Subscribe wish;
    wish.set_lidar(lidar.id());
    wish.set_kind(v1::SECTOR);
    wish.set_sector_deg(sector_deg);
    return wish;
}

device::CapturedSweep captured(const client::JoinedSweep& joined, const hub::LidarSnapshot& lidar) {
    const auto& scan = joined.scan;
    device::CapturedSweep sweep;
    sweep.sweep = scan.sweep;
    sweep.sweep.begun = joined.begun;
    sweep.lidar = lidar.id;
    sweep.lidar_number = lidar.number;
    sweep.sequence = joined.sequence;
    sweep.mode = scan.mode;
    sweep.answer_type = scan.answer_type;
    sweep.sample_duration = scan.sample_duration;
    sweep.clock_step = scan.clock_step;
    sweep.gap = scan.gap;
    return sweep;
}

/// What brings the times of a scan to UNIX time; to before it, which is no
/// time, if that is not known.
std::chrono::nanoseconds monotonic_to_unix(const frame::DecodedScan& scan) {
    const auto first = scan.first_time.time_since_epoch();
    return scan.first_unix.count() > 0 ? scan.first_unix - first : -first - 1ns;
}

}  // namespace

RemoteLidar::RemoteLidar(
    RemotePlace place,
    async::Worker& worker,
    hub::Hub& hub,
    LidarIds& ids,
    std::shared_ptr<spdlog::logger> log
)
    : place_(std::move(place))
    , worker_(worker)
    , hub_(hub)
    , ids_(ids)
    , log_(std::move(log))
    , client_(std::make_unique<client::Client>(
          worker.executor(),
          client::StreamUrl{false, place_.where.host, place_.where.port, ""},
          states_first()
      ))
    , frames_(hub.variants(), place_.number)
    , id_(place_.port_name)
    , stopped_(ended_.get_future()) {}

void RemoteLidar::start() {
    started_ = true;
    asio::post(worker_.executor(), [this] {
        publish({});
        worker_.tasks().spawn(live());
    });
}

void RemoteLidar::shut_down() {
    asio::post(worker_.executor(), [this] {
        if (client_) {
            client_->cancel();
        }
    });
}

asio::awaitable<void> RemoteLidar::live() {
    struct Ended {
        RemoteLidar& lidar;
        ~Ended() {
            lidar.client_.reset();  // which must not outlive the worker
            lidar.ended_.set_value();
        }
    } ended{*this};
    for (;;) {
        auto event = co_await client_->next();
        if (!event) {
            co_return;  // shut down
        }
        std::visit([this](auto& what) { take(std::move(what)); }, *event);
        if (due_wish_) {
            auto wish = *std::exchange(due_wish_, std::nullopt);
            co_await client_->set_wish(std::move(wish));
        }
    }
}

void RemoteLidar::take(const client::Connected& connected) {
    log_->info("connected to {}", connected.hello.server());
    there_.clear();
    chosen_.reset();
    is_refused_ = false;
    for (const auto& lidar : connected.hello.lidars()) {
        there_[lidar.number()] = lidar;
    }
    choose();
}

void RemoteLidar::take(const client::Disconnected& disconnected) {
    chosen_.reset();
    fail(disconnected.why);
}

void RemoteLidar::take(const v1::Lidar& lidar) {
    there_[lidar.number()] = lidar;
    if (!chosen_) {
        choose();
    } else if (*chosen_ == lidar.number() && !is_refused_) {
        mirror(lidar);
    }
}

void RemoteLidar::take(const v1::Subscribed&) {
    if (std::exchange(is_refused_, false) && chosen_) {
        mirror(there_.at(*chosen_));
    }
}

void RemoteLidar::take(const v1::StreamError& refusal) {
    if (refusal.code() == "lidar_not_found") {
        return;  // choose() says so, and waits for it
    }
    is_refused_ = true;
    const Problem why{{}, refusal.message(), refusal.hint()};
    if (fails_by(why)) {
        return;
    }
    if (refusals_.count(std::chrono::steady_clock::now())) {
        log_failure(why);
    }
    publish_failure(why);
}

void RemoteLidar::take(const v1::StreamStats& stats) {
    if (losses_.count(std::chrono::steady_clock::now())) {
        log_->warn("too slow for {}: {} frames lost so far", place_.url, stats.frames_dropped());
    }
}

void RemoteLidar::take(const client::LeftOut& left_out) {
    log_->warn("{}", left_out.why.cause);
}

/// Finds out which of the other gateway's lidars it is, and what to do then.
void RemoteLidar::choose() {
    std::string ids;
    std::vector<std::uint32_t> numbers;
    std::vector<hub::LidarNames> names;
    for (const auto& [number, lidar] : there_) {
        if (ids.size() < enough_ids) {
            ids += (ids.empty() ? "" : ", ") + lidar.id();
        } else if (!ids.ends_with(", ...")) {
            ids += ", ...";
        }
        numbers.push_back(number);
        names.push_back(names_there(lidar));
    }
    const auto& name = place_.where.id;
    auto found = hub::find_named(names, name);
    if (name.empty() && names.size() == 1) {
        found.index = 0;  // the only one
    }
    const auto gateway = fmt::format("the gateway at {}:{}", place_.where.host, place_.where.port);
    if (found.index) {
        chosen_ = numbers[*found.index];
        is_refused_ = false;  // the wish is sent again
        const auto& lidar = there_.at(*chosen_);
        due_wish_ = wish_for(lidar);
        mirror(lidar);
    } else if (found.is_ambiguous) {
        fail(
            {{},
             fmt::format("{} has several lidars that \"{}\" fits", gateway, name),
             "name one by its id: it has: " + ids}
        );
    } else if (name.empty() && !names.empty()) {
        fail(
            {{},
             fmt::format("{} has {} lidars", gateway, names.size()),
             fmt::format("say which: {}/ID; it has: {}", place_.url, ids)}
        );
    } else {
        fail(
            {{},
             name.empty() ? gateway + " has no lidar"
                          : fmt::format("{} has no lidar \"{}\"", gateway, name),
             ids.empty() ? "start it with one" : "it has: " + ids}
        );
    }
}

/// The name its user gave it, else the one it has there.
void RemoteLidar::claim_id(const v1::Lidar& lidar) {
    if (place_.name.empty() && lidar.id() != claimed_) {
        claimed_ = lidar.id();
        const auto& serial = lidar.device().serial_number();
        id_ = ids_.claim(place_.number, lidar.id(), serial.empty() ? lidar.id() : serial);
    }
}

void RemoteLidar::mirror(const v1::Lidar& lidar) {
    if (hops(lidar.url()) + 1 > most_hops) {
        give_up(
            {{},
             fmt::format(
                 "more than {} gateways one behind the other, or a loop of them",
                 most_hops
             ),
             "take the lidar from the gateway that it is attached to"}
        );
        return;
    }
    if (!is_lidar_name(lidar.id())) {
        give_up({{}, "the lidar there has a name that it cannot have here", "give it another there"}
        );
        return;
    }
    claim_id(lidar);
    hub::LidarSnapshot snapshot;
    snapshot.url = lidar.url() + std::string(via) + place_.url;
    snapshot.is_virtual = lidar.is_virtual();
    snapshot.is_stand_in = lidar.is_stand_in();
    snapshot.state = stream::from_message(lidar);
    publish(std::move(snapshot));
}

/// Ends the connection for what came over it, for a while.
void RemoteLidar::give_up(Problem why) {
    chosen_.reset();
    due_wish_.reset();
    client_->give_up(std::move(why));
}

/// Tells that it cannot be had, and of what is known of it.
void RemoteLidar::fail(const Problem& why) {
    if (fails_by(why)) {
        return;  // one attempt of many
    }
    log_failure(why);
    publish_failure(why);
}

/// Returns whether the state says already that the lidar is out of reach for this cause.
bool RemoteLidar::fails_by(const Problem& why) const {
    const auto& state = snapshot_->state;
    return state.phase == device::Phase::backing_off && state.cause == why.cause;
}

void RemoteLidar::log_failure(const Problem& why) {
    log_->warn("{}: {}; {}", place_.url, why.cause, why.hint);
}

void RemoteLidar::publish_failure(const Problem& why) {
    hub::LidarSnapshot snapshot = *snapshot_;
    snapshot.state.phase = device::Phase::backing_off;
    snapshot.state.since = std::chrono::system_clock::now();
    snapshot.state.cause = why.cause;
    snapshot.state.hint = why.hint;
    snapshot.state.rotation.measured_hz = 0;
    publish(std::move(snapshot));
}

void RemoteLidar::publish(hub::LidarSnapshot snapshot) {
    snapshot.number = place_.number;
    snapshot.id = id_;
    snapshot.port_name = place_.port_name;
    if (snapshot.url.empty()) {
        snapshot.url = place_.url;
    }
    snapshot_ = std::make_shared<const hub::LidarSnapshot>(std::move(snapshot));
    hub_.publish(hub::StateNews{snapshot_, stream::state_message(*snapshot_)});
}

void RemoteLidar::take(client::Scan scan) {
    auto& samples = scan.scan.sweep.samples;
    if (samples.empty() || !chosen_ || there_.at(*chosen_).id() != scan.lidar) {
        return;
    }
    if (scan.scan.without_times) {
        give_up(
            {{},
             fmt::format("{} sends scans without times, which were asked for", place_.url),
             "update the gateway there"}
        );
        return;
    }
    const auto arrival =
        std::chrono::floor<std::chrono::microseconds>(std::chrono::steady_clock::now());
    clock_.hear(samples.back().time, arrival);
    if (scan.kind == v1::SWEEP || scan.sector == 0) {
        offset_ = clock_.offset();
    }
    scan.scan.first_time += offset_;
    for (auto& sample : samples) {
        sample.time += offset_;
    }
    if (joiner_.take(std::move(scan))) {
        publish_sweep(arrival);
    }
}

/// Publishes what there is now of the sweep under way.
void RemoteLidar::publish_sweep(protocol::SampleTime arrival) {
    const auto& joined = joiner_.sweep();
    const auto& scan = joined.scan;
    if (joined.complete) {
        auto sweep = captured(joined, *snapshot_);
        sweep.monotonic_to_unix = monotonic_to_unix(scan);
        auto frames = frames_.of(sweep);
        auto shared = std::make_shared<const device::CapturedSweep>(std::move(sweep));
        hub_.publish(hub::SweepNews{place_.number, std::move(shared), std::move(frames)});
        return;
    }
    device::SweepProgress progress;
    progress.sweep = {scan.sweep.samples, joined.begun, scan.sweep.time_uncertainty};
    progress.sequence = joined.sequence;
    progress.mode = scan.mode;
    progress.answer_type = scan.answer_type;
    progress.sample_duration = scan.sample_duration;
    progress.monotonic_to_unix = monotonic_to_unix(scan);
    progress.clock_step = scan.clock_step;
    progress.gap = scan.gap;
    progress.arrival = arrival;
    hub_.publish(hub::SectorNews{place_.number, frames_.of(snapshot_->id, progress)});
}

Problem RemoteLidar::controlled_elsewhere() const {
    return {
        make_error_code(boost::system::errc::operation_not_supported),
        fmt::format("{} is another gateway's lidar, and only that can control it", id_),
        fmt::format("ask {}: usually http://{}:8080/", place_.where.host, place_.where.host)};
}

GatewayLidar::Done RemoteLidar::start_scan(std::string) {
    co_return controlled_elsewhere();
}

GatewayLidar::Done RemoteLidar::stop_scan() {
    co_return controlled_elsewhere();
}

GatewayLidar::Done RemoteLidar::reset() {
    co_return controlled_elsewhere();
}

GatewayLidar::Done RemoteLidar::update(api::LidarUpdate) {
    co_return controlled_elsewhere();
}

asio::awaitable<Result<device::Diagnosis, Problem>> RemoteLidar::diagnose() {
    co_return controlled_elsewhere();
}

}  // namespace sweepcast::gateway
