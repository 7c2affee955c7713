#include "server/gateway/gateway.hpp"

#include "driver/device/error.hpp"
#include "server/gateway/managed_lidar.hpp"
#include "server/gateway/remote_lidar.hpp"
#include "server/http/http_session.hpp"
#include "server/net/endpoint.hpp"
#include "server/stream/messages.hpp"
#include "server/stream/session.hpp"
#include "server/stream/tcp_transport.hpp"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/use_future.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <optional>
#include <utility>

namespace sweepcast::gateway {

namespace asio = boost::asio;
using asio::ip::tcp;
using namespace std::chrono_literals;

namespace {

constexpr auto lidars_end_within = 700ms;
constexpr auto sessions_end_within = 200ms;
constexpr auto cancelled_within = 100ms;
constexpr const char* farewell = "the gateway is shutting down";

/// Reports a coroutine that ended by an exception: a broken invariant, for nothing expected is
/// thrown.
async::TaskGroup::OnFailure log_failure(std::shared_ptr<spdlog::logger> log) {
    return [log = std::move(log)](std::exception_ptr failure) {
        try {
            std::rethrow_exception(failure);
        } catch (const std::exception& e) {
            log->error("a task failed: {}", e.what());
        }
    };
}

/// Ends a worker's sessions: those that do not take the farewell in time are cut off.
asio::awaitable<bool> end_tasks(async::Worker& worker, hub::LocalHub& hub) {
    hub.close_all(stream::closing_message(farewell), farewell);
    const bool all_ended = co_await worker.tasks().join(sessions_end_within);
    if (all_ended) {
        co_return true;
    }
    worker.tasks().cancel();
    co_return co_await worker.tasks().join(cancelled_within);
}

std::string describe_peer(const tcp::socket& socket) {
    error_code gone;
    const auto peer = socket.remote_endpoint(gone);
    return gone ? "tcp client" : "tcp " + net::to_text(peer);
}

/// Has a lidar obey on its own worker. The outcome is the state that the lidar is in then.
asio::awaitable<api::LidarControl::Outcome>
command(GatewayLidar& lidar, asio::awaitable<Result<void, Problem>> order) {
    auto obey = [](GatewayLidar& obeying, asio::awaitable<Result<void, Problem>> what
                ) -> asio::awaitable<api::LidarControl::Outcome> {
        const auto done = co_await std::move(what);
        const bool pending = !done && done.error().code == device::errc::pending;
        if (!done && !pending) {
            co_return done.error();
        }
        co_return api::Obeyed{obeying.snapshot(), pending};
    };
    co_return co_await async::run_on(lidar.worker().executor(), obey(lidar, std::move(order)));
}

std::vector<std::string> all_host_names(const std::vector<std::string>& given) {
    auto names = http::own_host_names();
    names.insert(names.end(), given.begin(), given.end());
    return names;
}

/// Returns what is wrong with the first of the names that is none, if there is one.
std::optional<Problem> bad_host_name(const std::vector<std::string>& names) {
    const auto bad =
        std::ranges::find_if_not(names, [](const auto& name) { return http::is_host_name(name); });
    if (bad == names.end()) {
        return std::nullopt;
    }
    return Problem{
        make_error_code(boost::system::errc::invalid_argument),
        fmt::format("\"{}\" is no host name", *bad),
        "give --host-name a name without scheme and port, such as robot.example.com"};
}

asio::awaitable<void> serve_tcp(
    tcp::socket socket,
    hub::LocalHub& hub,
    hub::MailboxLimits mailbox,
    std::shared_ptr<spdlog::logger> log
) {
    stream::SessionSettings settings{describe_peer(socket), std::nullopt, mailbox};
    const auto transport = stream::make_tcp_transport(std::move(socket));
    co_await stream::serve_subscriber(*transport, hub, std::move(settings), std::move(log));
}

}  // namespace

Result<std::unique_ptr<Gateway>, Problem>
Gateway::start(GatewayOptions options, const MakeLogger& make_logger) {
    if (auto problem = bad_host_name(options.host_names)) {
        return std::move(*problem);
    }
    std::unique_ptr<Gateway> gateway(new Gateway(std::move(options), make_logger));
    if (auto ready = gateway->set_up(make_logger); !ready) {
        // No lidar has been started, so all can go before the workers that they would run on.
        gateway->lidars_.clear();
        return ready.error();
    }
    for (auto& lidar : gateway->lidars_) {
        lidar->start();
    }
    gateway->http_->start();
    gateway->tcp_->start();
    return gateway;
}

Gateway::Gateway(GatewayOptions options, const MakeLogger& make_logger)
    : options_(std::move(options))
    , log_(make_logger("gateway"))
    , hosts_(all_host_names(options_.host_names))
    , virtual_lidars_(log_failure(log_))
    , ports_(options_.patterns, log_failure(log_), log_) {
    std::vector<hub::Hub::Executor> executors;
    for (std::size_t i = 0; i < options_.threads; ++i) {
        workers_.push_back(
            std::make_unique<async::Worker>(fmt::format("worker {}", i), log_failure(log_))
        );
        executors.push_back(workers_.back()->executor());
    }
    hub_ = std::make_unique<hub::Hub>(executors);
    for (std::size_t i = 0; i < workers_.size(); ++i) {
        apis_.emplace_back(hub_->local(i), static_cast<api::LidarControl&>(*this));
    }
}

Gateway::~Gateway() {
    stop();
    // A coroutine that did not end in time is destroyed with its worker, while what it refers to is
    // still there; the acceptors in turn need the workers' contexts.
    http_.reset();
    tcp_.reset();
    workers_.clear();
}

/// Adds the lidars and opens the listeners; starts neither.
Result<void, Problem> Gateway::set_up(const MakeLogger& make_logger) {
    // First what the options say: a wrong option is named even if another program has the ports.
    if (auto added = add_lidars(make_logger); !added) {
        return added;
    }
    if (auto listening = listen(make_logger); !listening) {
        return listening;
    }
    if (auto problem = own_upstream()) {
        return std::move(*problem);
    }
    return {};
}

Result<void, Problem> Gateway::listen(const MakeLogger& make_logger) {
    auto http = net::Listener::open(
        options_.http,
        workers_,
        options_.max_connections,
        [this, log = make_logger("http")](tcp::socket socket, std::size_t worker) {
            return http::serve_http(
                std::move(socket),
                {apis_[worker], hub_->local(worker), hosts_, options_.mailbox, log}
            );
        },
        make_logger("http")
    );
    if (!http) {
        return http.error();
    }
    http_ = std::move(*http);
    auto tcp = net::Listener::open(
        options_.tcp,
        workers_,
        options_.max_connections,
        [this, log = make_logger("tcp")](tcp::socket socket, std::size_t worker) {
            return serve_tcp(std::move(socket), hub_->local(worker), options_.mailbox, log);
        },
        make_logger("tcp")
    );
    if (!tcp) {
        return tcp.error();
    }
    tcp_ = std::move(*tcp);
    return {};
}

Result<void, Problem> Gateway::add_lidars(const MakeLogger& make_logger) {
    if (auto problem = name_clash(options_.lidars)) {
        return std::move(*problem);
    }
    // First of all the names that users gave: a port that is called the same must not take one.
    std::uint32_t number_named = 0;
    for (const auto& url : options_.lidars) {
        ++number_named;
        if (!url.name.empty()) {
            ids_.claim(number_named, url.name, url.name);
        }
    }
    for (const auto& url : options_.lidars) {
        const auto number = static_cast<std::uint32_t>(lidars_.size() + 1);
        if (const auto* remote = std::get_if<RemoteLidarUrl>(&url.where)) {
            add_remote(url, *remote, make_logger);
            continue;
        }
        auto where = place(url, number, make_logger);
        if (!where) {
            return where.error();
        }
        auto& worker = *workers_[lidars_.size() % workers_.size()];
        // A stand-in's name would go on in the log when a real lidar has taken its place.
        const auto& name = where->name.empty() ? where->port_name : where->name;
        const auto logged_as = where->is_stand_in ? std::to_string(number) : name;
        auto log = make_logger("lidar " + logged_as);
        lidars_.push_back(std::make_unique<ManagedLidar>(
            std::move(*where),
            options_for(url),
            worker,
            *hub_,
            ids_,
            *options_.memory,
            std::move(log)
        ));
    }
    return {};
}

/// Whether `remote` is this gateway's own stream, as far as its URL tells.
bool Gateway::is_own(const RemoteLidarUrl& remote) const {
    error_code no_address;
    const auto address = asio::ip::make_address(remote.host, no_address);
    const bool is_here = remote.host == "localhost" ||
                         (!no_address && (address.is_loopback() || address.is_unspecified() ||
                                          address == tcp_->endpoint().address()));
    return is_here && remote.port == std::to_string(tcp_->endpoint().port());
}

/// What is wrong if a lidar is to come from this gateway itself.
std::optional<Problem> Gateway::own_upstream() const {
    for (const auto& url : options_.lidars) {
        const auto* remote = std::get_if<RemoteLidarUrl>(&url.where);
        if (remote != nullptr && is_own(*remote)) {
            return Problem{
                make_error_code(boost::system::errc::too_many_symbolic_link_levels),
                fmt::format("lidar \"{}\" is at this gateway's own stream", url.text),
                "name another gateway, or the lidar's port"};
        }
    }
    return std::nullopt;
}

void Gateway::add_remote(
    const LidarUrl& url,
    const RemoteLidarUrl& remote,
    const MakeLogger& make_logger
) {
    const auto number = static_cast<std::uint32_t>(lidars_.size() + 1);
    const auto& wished = url.name.empty() ? port_name(url) : url.name;
    const auto name = ids_.claim(number, wished, wished);
    lidars_.push_back(std::make_unique<RemoteLidar>(
        RemotePlace{number, url.text.substr(0, url.text.find('?')), url.name, name, remote},
        *workers_[lidars_.size() % workers_.size()],
        *hub_,
        ids_,
        make_logger("lidar " + name)
    ));
}

/// The device's options, with what the lidar's own URL says of them.
device::DeviceOptions Gateway::options_for(const LidarUrl& url) const {
    auto options = options_.device;
    if (!url.mode.empty()) {
        options.mode = url.mode;
    }
    options.speed_hz = url.hz.value_or(options.speed_hz);
    const auto* way = std::get_if<link::LinkUrl>(&url.where);
    if (way != nullptr && std::holds_alternative<link::SerialPlace>(way->where)) {
        const auto& port = std::get<link::SerialPlace>(way->where);
        options.baud = port.baud;
        const auto hints = options_.memory->baud_hints(port.path);
        options.baud_hints.insert(options.baud_hints.end(), hints.begin(), hints.end());
    }
    if (url.baud_hint) {
        options.baud_hints.insert(options.baud_hints.begin(), *url.baud_hint);
    }
    return options;
}

/// Where a lidar is and how to open it; starts the virtual ones.
Result<LidarPlace, Problem>
Gateway::place(const LidarUrl& url, std::uint32_t number, const MakeLogger& make_logger) {
    // Unique from the start, so that the name goes on meaning this lidar once it has its serial
    // number.
    const auto port = port_name(url);
    const auto& wished = url.name.empty() ? port : url.name;
    const auto name = ids_.claim(number, wished, wished);
    // A named lidar can be addressed by its port too, unless another lidar's port is called the
    // same.
    const auto same_port = std::ranges::count(options_.lidars, port, port_name);
    LidarPlace place{
        .number = number,
        .url = url.text,
        .name = url.name,
        .port_name = url.name.empty() || same_port > 1 ? name : port,
        .home = {},
        .is_virtual = false,
        .is_stand_in = url.is_stand_in,
        .port = {},
        .motor_off_after = url.motor_off_after};
    link::LinkUrl way;
    if (const auto* wanted = std::get_if<VirtualLidarUrl>(&url.where)) {
        auto path = virtual_lidars_.add(*wanted, number, make_logger(name));
        if (!path) {
            return path.error();
        }
        way = {*path, link::SerialPlace{*path, std::nullopt}};
        place.is_virtual = true;
    } else {
        way = std::get<link::LinkUrl>(url.where);
    }
    const auto executor = workers_[(number - 1) % workers_.size()]->executor();
    const bool can_move = !place.is_virtual && std::holds_alternative<link::SerialPlace>(way.where);
    if (place.is_stand_in) {
        place.port =
            std::make_unique<LidarPort>(executor, std::move(way), ports_, number, [this, number] {
                virtual_lidars_.end(number);
            });
        return place;
    }
    if (!can_move) {
        place.port = std::make_unique<LidarPort>(executor, std::move(way));
        return place;
    }
    std::optional<RememberedLidar> remembered;
    if (!url.is_found) {
        place.home = std::get<link::SerialPlace>(way.where).path;
        remembered = options_.memory->lidar_named_by(place.home);
    }
    place.port = std::make_unique<LidarPort>(
        executor,
        std::move(way),
        ports_,
        number,
        std::move(remembered)
    );
    return place;
}

void Gateway::stop() {
    if (std::exchange(stopped_, true)) {
        return;
    }
    for (auto* listener : {http_.get(), tcp_.get()}) {
        if (listener != nullptr) {
            listener->close();
        }
    }
    stop_lidars();
    ports_.stop();
    end_sessions();
    for (auto& worker : workers_) {
        worker->stop();
    }
    virtual_lidars_.stop();
}

void Gateway::stop_lidars() {
    for (auto& lidar : lidars_) {
        lidar->shut_down();
    }
    const auto deadline = std::chrono::steady_clock::now() + lidars_end_within;
    for (auto& lidar : lidars_) {
        if (lidar->started() &&
            lidar->stopped().wait_until(deadline) != std::future_status::ready) {
            log_->warn("a lidar did not stop in time; its motor may still turn");
        }
    }
}

void Gateway::end_sessions() {
    std::vector<std::future<bool>> ends;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
        ends.push_back(asio::co_spawn(
            workers_[i]->executor(),
            end_tasks(*workers_[i], hub_->local(i)),
            asio::use_future
        ));
    }
    for (auto& end : ends) {
        if (!end.get()) {
            log_->warn("some clients did not end in time");
        }
    }
}

asio::awaitable<api::LidarControl::Outcome> Gateway::start(std::uint32_t lidar, std::string mode) {
    auto& managed = *lidars_.at(lidar - 1);
    co_return co_await command(managed, managed.start_scan(std::move(mode)));
}

asio::awaitable<api::LidarControl::Outcome> Gateway::stop(std::uint32_t lidar) {
    auto& managed = *lidars_.at(lidar - 1);
    co_return co_await command(managed, managed.stop_scan());
}

asio::awaitable<api::LidarControl::Outcome>
Gateway::update(std::uint32_t lidar, api::LidarUpdate update) {
    auto& managed = *lidars_.at(lidar - 1);
    co_return co_await command(managed, managed.update(std::move(update)));
}

asio::awaitable<api::LidarControl::Outcome> Gateway::reset(std::uint32_t lidar) {
    auto& managed = *lidars_.at(lidar - 1);
    co_return co_await command(managed, managed.reset());
}

asio::awaitable<Result<device::Diagnosis, Problem>> Gateway::diagnose(std::uint32_t lidar) {
    auto& managed = *lidars_.at(lidar - 1);
    co_return co_await async::run_on(managed.worker().executor(), managed.diagnose());
}

}  // namespace sweepcast::gateway
