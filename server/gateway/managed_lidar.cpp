#include "server/gateway/managed_lidar.hpp"

#include "driver/device/advice.hpp"
#include "driver/diagnosis/diagnose.hpp"
#include "driver/protocol/reply.hpp"
#include "server/gateway/demand.hpp"
#include "server/stream/messages.hpp"

#include <boost/asio/experimental/awaitable_operators.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace sweepcast::gateway {

namespace asio = boost::asio;

namespace {

device::Port device_port(LidarPort& port) {
    return {
        .open = [&port](std::uint32_t baud) { return port.open(baud); },
        .wait_for_change = [&port](std::chrono::steady_clock::time_point then
                           ) { return port.wait_for_change(then); },
        .is_it = [&port](const protocol::DeviceInfo& info) { return port.is_it(info); },
        .baud_hint = [&port] { return port.baud_hint(); },
        .has_moved = [&port] { return port.has_moved(); }};
}

}  // namespace

ManagedLidar::ManagedLidar(
    LidarPlace place,
    device::DeviceOptions options,
    async::Worker& worker,
    hub::Hub& hub,
    LidarIds& ids,
    LidarMemory& memory,
    std::shared_ptr<spdlog::logger> log
)
    : place_(std::move(place))
    , worker_(worker)
    , hub_(hub)
    , ids_(ids)
    , memory_(memory)
    , log_(std::move(log))
    , frames_(hub.variants(), place_.number)
    , path_(place_.port->path())
    , stopped_(ended_.get_future())
    , device_(worker.executor(), device_port(*place_.port), std::move(options), *this, log_) {}

void ManagedLidar::start() {
    started_ = true;
    asio::post(worker_.executor(), [this] {
        on_state(device_.state());
        worker_.tasks().spawn(live());
    });
}

void ManagedLidar::shut_down() {
    asio::post(worker_.executor(), [this] { device_.shut_down(); });
}

GatewayLidar::Done ManagedLidar::start_scan(std::string mode) {
    co_return obeyed(co_await device_.start(std::move(mode)));
}

GatewayLidar::Done ManagedLidar::stop_scan() {
    co_return obeyed(co_await device_.stop());
}

GatewayLidar::Done ManagedLidar::reset() {
    co_return obeyed(co_await device_.reset());
}

GatewayLidar::Done ManagedLidar::update(api::LidarUpdate update) {
    const auto& modes = device_.state().modes;
    if (update.mode && !modes.empty() && device::find_mode(modes, *update.mode) == nullptr) {
        co_return device::unknown_mode(*update.mode, modes);
    }
    if (update.speed_hz) {
        if (auto set = device_.set_speed(*update.speed_hz); !set) {
            co_return set.error();
        }
    }
    if (update.mode) {
        co_return obeyed(co_await device_.set_mode(*update.mode));
    }
    co_return obeyed({});
}

/// Returns how a command ended: it is pending if the device has taken it while there is no lidar
/// that could obey.
Result<void, Problem> ManagedLidar::obeyed(Result<void, Problem> done) const {
    if (done && !device_.in_hand()) {
        return device::still_pending(device_.state().phase);
    }
    return done;
}

asio::awaitable<Result<device::Diagnosis, Problem>> ManagedLidar::diagnose() {
    const auto baud = device_.state().line.baud;
    auto examine = [executor = worker_.executor(), way = place_.port->way(), baud] {
        std::vector<std::uint32_t> hints(baud > 0 ? 1 : 0, baud);
        return diagnosis::diagnose(executor, way, std::move(hints), {});
    };
    auto examined = co_await device_.diagnose(std::move(examine));
    if (!examined) {
        co_return examined.error();
    }
    if (!*examined) {
        co_return diagnosis::diagnosis_of(device_.state(), place_.port->way());
    }
    co_return std::move(**examined);
}

asio::awaitable<void> ManagedLidar::live() {
    struct Ended {
        std::promise<void>& promise;
        ~Ended() { promise.set_value(); }
    } ended{ended_};
    using namespace asio::experimental::awaitable_operators;
    if (place_.motor_off_after) {
        co_await (device_.run() || obey_demand(*place_.motor_off_after));
    } else {
        co_await device_.run();
    }
}

/// Has the motor off while nobody watches. Looks at a few numbers five times a second, which costs
/// nothing, and needs nobody to tell it.
asio::awaitable<void> ManagedLidar::obey_demand(std::chrono::seconds patience) {
    using namespace std::chrono_literals;
    Demand demand(patience, std::chrono::steady_clock::now());
    asio::steady_timer pause(worker_.executor());
    for (;;) {
        const bool watched = !hub_.variants().wanted(place_.number).empty();
        device_.set_demand(demand.take(watched, std::chrono::steady_clock::now()));
        pause.expires_after(200ms);
        co_await pause.async_wait(asio::use_awaitable);
    }
}

void ManagedLidar::on_state(const device::DeviceState& state) {
    auto snapshot = std::make_shared<hub::LidarSnapshot>();
    snapshot->number = place_.number;
    follow_port(state.info);
    snapshot->port_name = place_.port_name;
    snapshot->url = place_.url;
    snapshot->is_virtual = place_.is_virtual;
    snapshot->is_stand_in = place_.is_stand_in;
    snapshot->state = state;
    claim_id(state.info);
    remember(state);
    snapshot->id = id_;
    snapshot_ = snapshot;
    hub_.publish(hub::StateNews{snapshot_, stream::state_message(*snapshot_)});
}

/// Names the port where the lidar is now, if it has moved. One that takes a stand-in's place is
/// told of once it is identified: until then all that is known is the stand-in's.
void ManagedLidar::follow_port(const std::optional<protocol::DeviceInfo>& info) {
    const auto path = place_.port->path();
    if (path == path_ ||
        (place_.is_stand_in && (!info || protocol::serial_text(info->serial) == named_for_))) {
        return;
    }
    path_ = path;
    place_.is_virtual = false;
    place_.is_stand_in = false;
    const auto parameters = place_.url.find('?');
    place_.url.replace(0, std::min(parameters, place_.url.size()), path);
    place_.port_name = link::short_name(place_.port->way());
}

/// Remembers where the lidar is and how fast it speaks.
void ManagedLidar::remember(const device::DeviceState& state) {
    if (!state.info || state.line.baud == 0 || place_.is_virtual) {
        return;
    }
    const auto noted = memory_.note(
        protocol::serial_text(state.info->serial),
        place_.port->path(),
        state.line.baud,
        place_.home
    );
    if (!noted) {
        log_->warn("{}: {}", noted.error().cause, noted.error().hint);
    }
}

/// The name its user gave it, else the port's until the lidar is identified, then its serial
/// number; anew only for another lidar.
void ManagedLidar::claim_id(const std::optional<protocol::DeviceInfo>& info) {
    const auto serial = info ? protocol::serial_text(info->serial) : std::string();
    if (id_.empty()) {
        id_ = place_.name.empty() ? place_.port_name : place_.name;
    }
    if (place_.name.empty() && !serial.empty() && serial != named_for_) {
        named_for_ = serial;
        id_ = ids_.claim(place_.number, protocol::short_serial_text(info->serial), serial);
    }
}

void ManagedLidar::on_sweep(device::CapturedSweep sweep) {
    sweep.lidar = snapshot_->id;
    sweep.lidar_number = place_.number;
    auto frames = frames_.of(sweep);
    auto shared = std::make_shared<const device::CapturedSweep>(std::move(sweep));
    hub_.publish(hub::SweepNews{place_.number, std::move(shared), std::move(frames)});
}

void ManagedLidar::on_progress(const device::SweepProgress& progress) {
    hub_.publish(hub::SectorNews{place_.number, frames_.of(snapshot_->id, progress)});
}

}  // namespace sweepcast::gateway
