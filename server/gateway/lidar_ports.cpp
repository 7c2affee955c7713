#include "server/gateway/lidar_ports.hpp"

#include "driver/device/find_baud.hpp"
#include "driver/link/device_node.hpp"
#include "driver/link/discovery.hpp"
#include "driver/link/open_link.hpp"
#include "driver/link/port_holder.hpp"
#include "driver/protocol/reply.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_future.hpp>

#include <algorithm>
#include <utility>

namespace sweepcast::gateway {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

constexpr auto look_interval = 250ms;
constexpr auto ask_again_after = 300ms;
/// A lidar that was just plugged in boots first.
constexpr auto ask_for = 15s;
constexpr auto ends_within = 200ms;

std::string shortened(const std::string& serial) {
    constexpr std::size_t digits = 8;
    return serial.substr(0, digits);
}

/// The lidar that answers at `path`; nothing if none does.
asio::awaitable<std::optional<device::Found>>
ask_who(std::string path, std::vector<std::uint32_t> baud_hints) {
    const auto bauds = device::bauds_to_try(baud_hints);
    link::LinkUrl url{path, link::SerialPlace{path, {}}};
    auto link =
        co_await link::open_link(co_await asio::this_coro::executor, std::move(url), bauds.front());
    if (!link) {
        co_return std::nullopt;
    }
    device::Conversation talk(**link);
    const auto found = co_await device::find_baud(talk, bauds);
    if (!found) {
        co_return std::nullopt;
    }
    co_return *found;
}

}  // namespace

LidarPorts::LidarPorts(
    std::vector<std::string> patterns,
    const async::TaskGroup::OnFailure& on_failure,
    std::shared_ptr<spdlog::logger> log
)
    : patterns_(std::move(patterns))
    , log_(std::move(log))
    , worker_(std::make_unique<async::Worker>("lidar search", on_failure)) {
    wanted_ = std::make_unique<async::Notifier>(worker_->executor());
    for (const auto& path : link::ports_worth_a_look(patterns_)) {
        known_.insert_or_assign(
            link::device_node(path),
            Known{.look = link::PathLook(path), .was_there = true}
        );
    }
    asio::post(worker_->executor(), [this] { worker_->tasks().spawn(search()); });
}

LidarPorts::~LidarPorts() {
    stop();
}

void LidarPorts::stop() {
    if (std::exchange(stopped_, true)) {
        return;
    }
    auto end = [](async::TaskGroup& tasks) -> asio::awaitable<bool> {
        tasks.cancel();
        co_return co_await tasks.join(ends_within);
    };
    (void)asio::co_spawn(worker_->executor(), end(worker_->tasks()), asio::use_future).get();
    worker_->stop();
}

void LidarPorts::add(
    std::uint32_t number,
    const std::string& path,
    std::function<void()> on_move,
    std::optional<RememberedLidar> remembered
) {
    const std::scoped_lock lock(mutex_);
    Lidar lidar{path, std::move(on_move)};
    if (remembered) {
        lidar.serial = std::move(remembered->serial);
        lidar.baud = remembered->baud;
    }
    lidars_.insert_or_assign(number, std::move(lidar));
}

void LidarPorts::add_vacant(
    std::uint32_t number,
    const std::string& path,
    std::function<void()> on_move
) {
    {
        const std::scoped_lock lock(mutex_);
        Lidar lidar{path, std::move(on_move)};
        lidar.vacant = true;
        lidar.sought = true;
        lidars_.insert_or_assign(number, std::move(lidar));
    }
    asio::post(worker_->executor(), [this] { wanted_->notify(); });
}

std::string LidarPorts::path_of(std::uint32_t number) const {
    const std::scoped_lock lock(mutex_);
    return lidars_.at(number).path;
}

std::uint32_t LidarPorts::baud_at_path(std::uint32_t number) const {
    const std::scoped_lock lock(mutex_);
    return lidars_.at(number).baud_at_path;
}

void LidarPorts::lost(std::uint32_t number) {
    const std::scoped_lock lock(mutex_);
    lidars_.at(number).in_hand = false;
}

void LidarPorts::seek(std::uint32_t number, std::uint32_t baud) {
    const std::scoped_lock lock(mutex_);
    auto& lidar = lidars_.at(number);
    lidar.in_hand = false;
    if (lidar.met) {
        lidar.baud = baud;
    }
    if (lidar.serial.empty() || std::exchange(lidar.sought, true)) {
        return;
    }
    asio::post(worker_->executor(), [this] { wanted_->notify(); });
}

bool LidarPorts::is_it(std::uint32_t number, const std::string& path, const std::string& serial) {
    const std::scoped_lock lock(mutex_);
    auto& lidar = lidars_.at(number);
    if (lidar.path != path) {  // moved since: of two that swapped, the other one told
        return false;
    }
    if (lidar.vacant && lidar.serial.empty()) {
        return true;
    }
    if (lidar.serial == serial) {
        take(lidar, serial);
        return true;
    }
    auto* other = owner_of(serial);
    if (other != nullptr && !other->in_hand) {
        move(lidar, other->path);
        move(*other, path);
        return false;
    }
    if (lidar.serial.empty() || lidar.vacant) {
        take(lidar, serial);
        return true;
    }
    if (!lidar.replaced) {
        log_->warn(
            "{}: lidar {} is there, and not {}: looking for that elsewhere first",
            lidar.path,
            shortened(serial),
            shortened(lidar.serial)
        );
        lidar.replaced = Clock::now();
    }
    if (Clock::now() - *lidar.replaced < adopt_after) {
        return false;
    }
    log_->info(
        "{}: lidar {} takes the place of {}",
        lidar.path,
        shortened(serial),
        shortened(lidar.serial)
    );
    take(lidar, serial);
    return true;
}

/// The lidar of that serial number. Call with mutex_ held, as all of these.
LidarPorts::Lidar* LidarPorts::owner_of(const std::string& serial) {
    const auto found = std::ranges::find_if(lidars_, [&](const auto& each) {
        return each.second.serial == serial;
    });
    return found == lidars_.end() ? nullptr : &found->second;
}

/// One that is still to be had.
LidarPorts::Lidar* LidarPorts::vacant_place() {
    const auto found = std::ranges::find_if(lidars_, [](const auto& each) {
        return each.second.vacant && each.second.sought;
    });
    return found == lidars_.end() ? nullptr : &found->second;
}

void LidarPorts::take(Lidar& lidar, const std::string& serial) {
    lidar.serial = serial;
    lidar.vacant = false;
    lidar.met = true;
    lidar.in_hand = true;
    lidar.sought = false;
    lidar.replaced.reset();
}

void LidarPorts::move(Lidar& lidar, const std::string& path, std::uint32_t baud) {
    log_->info("lidar {} is at {} now, and not at {}", shortened(lidar.serial), path, lidar.path);
    lidar.path = path;
    lidar.baud_at_path = baud;
    lidar.sought = false;
    lidar.replaced.reset();
    lidar.on_move();
}

/// Vacant until it is in hand there: should it be gone again by then, another one may have the
/// place.
void LidarPorts::fill(Lidar& vacant, const std::string& path, const Known& newcomer) {
    log_->info(
        "lidar {} at {} takes the place of the virtual one",
        shortened(newcomer.serial),
        path
    );
    vacant.serial = newcomer.serial;
    vacant.path = path;
    vacant.baud = newcomer.baud;
    vacant.baud_at_path = newcomer.baud;
    vacant.sought = false;
    vacant.on_move();
}

bool LidarPorts::is_taken(const std::string& node) const {
    return std::ranges::any_of(lidars_, [&](const auto& each) {
        return link::device_node(each.second.path) == node;
    });
}

bool LidarPorts::any_sought() const {
    const std::scoped_lock lock(mutex_);
    return std::ranges::any_of(lidars_, [](const auto& each) { return each.second.sought; });
}

/// Whether one is that was not met since the start.
bool LidarPorts::any_sought_from_start() const {
    const std::scoped_lock lock(mutex_);
    return std::ranges::any_of(lidars_, [](const auto& each) {
        return each.second.sought && !each.second.met;
    });
}

std::vector<std::uint32_t> LidarPorts::sought_bauds() const {
    const std::scoped_lock lock(mutex_);
    std::vector<std::uint32_t> bauds;
    for (const auto& [number, lidar] : lidars_) {
        if (lidar.sought) {
            bauds.push_back(lidar.baud);
        }
    }
    return bauds;
}

/// That lidar, if there is one, answered at `path`.
void LidarPorts::answered(const std::string& path, const Known& known) {
    const std::scoped_lock lock(mutex_);
    if (known.serial.empty() || is_taken(link::device_node(path))) {
        return;
    }
    auto* owner = owner_of(known.serial);
    auto* vacant = owner == nullptr ? vacant_place() : nullptr;
    if (owner != nullptr && owner->sought) {
        move(*owner, path, known.baud);
    } else if (vacant != nullptr) {
        fill(*vacant, path, known);
    }
}

asio::awaitable<void> LidarPorts::search() {
    for (;;) {
        if (any_sought()) {
            look_around();
        }
        const auto next = any_sought() ? Clock::now() + look_interval : Clock::time_point::max();
        co_await wanted_->wait_until(next);
    }
}

/// Asks at each port that newly appeared, or that is worth it for another reason, who is there.
void LidarPorts::look_around() {
    const bool from_start = any_sought_from_start();
    std::erase_if(known_, [](const auto& each) {
        return link::PathLook(each.first) != each.second.look;
    });
    for (const auto& path : link::ports_worth_a_look(patterns_)) {
        const auto node = link::device_node(path);
        const link::PathLook look(path);
        const auto found = known_.find(node);
        auto known = found != known_.end() && found->second.look == look ? found->second
                                                                         : Known{.look = look};
        if (known.asked || (known.was_there && !from_start)) {
            answered(path, known);
            continue;
        }
        {
            const std::scoped_lock lock(mutex_);
            if (!look.there() || is_taken(node)) {
                continue;
            }
        }
        known.asked = true;
        known_.insert_or_assign(node, known);
        worker_->tasks().spawn(ask(path, known));
    }
}

/// Asks until someone answers, nobody is sought, or it is in vain; once if the port was there from
/// the start.
asio::awaitable<void> LidarPorts::ask(std::string path, Known known) {
    const auto node = link::device_node(path);
    const auto give_up = known.was_there ? Clock::now() : Clock::now() + ask_for;
    log_->info(
        "looking for a lidar on {}{}",
        path,
        known.was_there ? "" : ", which newly appeared"
    );
    async::Notifier nothing(worker_->executor());
    do {
        std::optional<device::Found> lidar;
        if (link::find_port_competitors(node).empty()) {
            auto hints = sought_bauds();
            lidar = co_await ask_who(path, std::move(hints));
        }
        if (lidar) {
            known.serial = protocol::serial_text(lidar->info.serial);
            known.baud = lidar->baud;
            log_->info("{}: lidar {}", path, shortened(known.serial));
            known_.insert_or_assign(node, known);
            answered(path, known);
            co_return;
        }
        co_await nothing.wait_until(Clock::now() + ask_again_after);
    } while (any_sought() && Clock::now() < give_up && link::PathLook(path) == known.look);
    // Not known then who is there: it is asked again for the next one that is sought.
    const auto found = known_.find(node);
    if (found != known_.end() && found->second.look == known.look && !any_sought()) {
        found->second.asked = false;
    }
}

}  // namespace sweepcast::gateway
