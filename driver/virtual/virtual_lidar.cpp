#include "driver/virtual/virtual_lidar.hpp"

#include "driver/async/task_group.hpp"
#include "driver/virtual/error.hpp"
#include "driver/virtual/pty.hpp"
#include "driver/virtual/tcp_port.hpp"
#include "driver/virtual/uart.hpp"
#include "driver/virtual/udp_port.hpp"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace asio = boost::asio;
using namespace std::chrono_literals;

namespace {

// Measurements are written in pieces of this time: less than the buffering of any real USB adapter,
// and coarse enough to cost no more than a few percent of a core.
constexpr auto shortest_step = 2ms;

constexpr auto report_period = 1s;

Moment now() {
    return std::chrono::steady_clock::now();
}

Problem invalid(std::string cause, std::string hint) {
    return {errc::invalid_option, std::move(cause), std::move(hint)};
}

std::optional<Problem> check(const VirtualLidarOptions& options) {
    constexpr double most_noise_mm = 10'000.0;
    if (find_persona(options.model) == nullptr) {
        std::string known;
        for (const auto& persona : personas()) {
            known += known.empty() ? "" : ", ";
            known += persona.key;
        }
        return invalid("there is no model \"" + options.model + "\"", "known models: " + known);
    }
    if (!options.serial.empty() && !parse_serial(options.serial)) {
        return invalid(
            "the serial number \"" + options.serial + "\" is not 32 hex digits",
            "give 16 bytes as hex digits, e.g. A0E1C2D3B4F5968778695A4B3C2D1E0F"
        );
    }
    // Written so that NaN is refused.
    if (options.noise_mm && !(*options.noise_mm >= 0.0 && *options.noise_mm <= most_noise_mm)) {
        return invalid("the noise is not in 0..10000 mm", "give a standard deviation such as 5");
    }
    if (!(options.dropout >= 0.0 && options.dropout <= 1.0)) {
        return invalid("the dropout is not in 0..1", "give a fraction such as 0.05");
    }
    if (options.loop && options.play.empty()) {
        return invalid("there is no capture to loop", "give one with --play");
    }
    if (!options.link.empty() && !options.listen.empty()) {
        return invalid(
            "only a pseudo terminal can have a link",
            "leave out the link or the address"
        );
    }
    return std::nullopt;
}

SerialNumber serial_of(const VirtualLidarOptions& options) {
    if (const auto given = parse_serial(options.serial)) {
        return *given;
    }
    // With the link in it, so that several on one machine differ, and each stays itself.
    return serial_from(options.model + "|" + options.link + "|" + std::to_string(options.seed));
}

Result<std::shared_ptr<const World>, Problem> world_of(const VirtualLidarOptions& options) {
    if (options.world.empty()) {
        return std::make_shared<const World>(World::living_room());
    }
    auto loaded = World::load(options.world);
    if (!loaded) {
        return std::move(loaded).error();
    }
    return std::make_shared<const World>(std::move(*loaded));
}

Result<Faults, Problem> faults_of(const VirtualLidarOptions& options) {
    Faults faults;
    for (const auto& text : options.faults) {
        if (auto added = add_fault(faults, text); !added) {
            return std::move(added).error();
        }
    }
    return faults;
}

// Null if none is to be played.
Result<std::unique_ptr<Playback>, Problem> playback_of(const VirtualLidarOptions& options) {
    if (options.play.empty()) {
        return std::unique_ptr<Playback>();
    }
    return Playback::load(options.play, options.loop);
}

template <class Port>
Result<std::unique_ptr<HostPort>, Problem> as_host_port(Result<std::unique_ptr<Port>, Problem> port
) {
    if (!port) {
        return std::move(port).error();
    }
    return std::unique_ptr<HostPort>(std::move(*port));
}

Result<std::unique_ptr<HostPort>, Problem> open_port(
    const asio::any_io_executor& executor,
    const VirtualLidarOptions& options,
    const Persona& persona
) {
    if (options.listen.empty()) {
        return as_host_port(Pty::open(executor, persona.baud));
    }
    const auto address = parse_listen_address(options.listen, persona.connection);
    if (!address) {
        return address.error();
    }
    return address->transport == Transport::tcp ? as_host_port(TcpPort::listen(executor, *address))
                                                : as_host_port(UdpPort::listen(executor, *address));
}

// Behind a serial bridge a scanner does not know of the network.
bool on_ethernet(const VirtualLidarOptions& options, const Persona& persona) {
    return persona.connection == Connection::ethernet && !options.listen.empty();
}

}  // namespace

struct VirtualLidar::Parts {
    std::shared_ptr<spdlog::logger> logger;
    asio::any_io_executor executor;
    std::unique_ptr<HostPort> port;
    bool any_baud;
    std::optional<PortLink> link;
    std::optional<Recording> recording;
    const Persona* persona;
    SerialNumber serial;
    Beam beam;
    EmulatorSettings settings;
    std::unique_ptr<Playback> playback;
};

Result<std::unique_ptr<VirtualLidar>, Problem> VirtualLidar::create(
    asio::any_io_executor executor,
    const VirtualLidarOptions& options,
    std::shared_ptr<spdlog::logger> logger
) {
    if (auto problem = check(options)) {
        return std::move(*problem);
    }
    auto world = world_of(options);
    if (!world) {
        return std::move(world).error();
    }
    auto faults = faults_of(options);
    if (!faults) {
        return std::move(faults).error();
    }
    auto playback = playback_of(options);
    if (!playback) {
        return std::move(playback).error();
    }
    const auto* const persona = *playback ? &(*playback)->persona() : find_persona(options.model);
    auto port = open_port(executor, options, *persona);
    if (!port) {
        return std::move(port).error();
    }
    const BeamSettings beam{
        .noise_mm = options.noise_mm,
        .dropout = options.dropout,
        .seed = options.seed};
    Parts parts{
        .logger = std::move(logger),
        .executor = executor,
        .port = std::move(*port),
        .any_baud = options.any_baud,
        .link = {},
        .recording = {},
        .persona = persona,
        .serial = *playback && options.serial.empty() ? (*playback)->serial() : serial_of(options),
        .beam = Beam(std::move(*world), persona->beam, beam),
        .settings =
            {.faults = *faults,
             .seed = options.seed,
             .on_ethernet = on_ethernet(options, *persona),
             .playback = playback->get()},
        .playback = std::move(*playback),
    };
    if (!options.recording.empty()) {
        auto recording = Recording::create(options.recording);
        if (!recording) {
            return std::move(recording).error();
        }
        parts.recording = std::move(*recording);
    }
    if (!options.link.empty()) {
        auto link = PortLink::create(options.link, parts.port->address());
        if (!link) {
            return std::move(link).error();
        }
        parts.link = std::move(*link);
    }
    return std::unique_ptr<VirtualLidar>(new VirtualLidar(std::move(parts)));
}

VirtualLidar::VirtualLidar(Parts&& parts)
    : logger_(std::move(parts.logger))
    , executor_(parts.executor)
    , port_(std::move(parts.port))
    , any_baud_(parts.any_baud)
    , link_(std::move(parts.link))
    , recording_(std::move(parts.recording))
    , playback_(std::move(parts.playback))
    , persona_(parts.persona)
    , emulator_(
          *parts.persona,
          parts.serial,
          std::move(parts.beam),
          now(),
          [this](const Event& event) { log_event(event); },
          parts.settings
      )
    , next_step_(executor_)
    , line_time_(executor_)
    , stopped_(executor_, std::chrono::steady_clock::time_point::max()) {
    const auto linked = link_ ? " (link " + link_->path() + ")" : std::string();
    logger_->info(
        "{} listening on {}{}, serial {}",
        persona_->title,
        port(),
        linked,
        protocol::short_serial_text(parts.serial)
    );
}

asio::awaitable<void> VirtualLidar::run() {
    // Cancelled or stopped, it ends the same way: by waiting for what it has spawned.
    co_await asio::this_coro::throw_if_cancelled(false);
    async::TaskGroup tasks(executor_, [this](std::exception_ptr failure) {
        failure_ = std::move(failure);
        stop();
    });
    tasks.spawn(read_host());
    tasks.spawn(keep_pace());
    if (!stopping_) {
        boost::system::error_code ignored;  // how the wait ends makes no difference
        co_await stopped_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    }
    tasks.cancel();
    for (bool ended = false; !ended;) {
        ended = co_await tasks.join(1s);
    }
    link_.reset();
    logger_->info("{} stopped", port());
    if (failure_) {
        std::rethrow_exception(failure_);
    }
}

void VirtualLidar::stop() {
    stopping_ = true;
    stopped_.cancel();
}

asio::awaitable<void> VirtualLidar::read_host() {
    std::array<std::uint8_t, 2048> buffer{};
    while (true) {
        const auto received = port_->read_some(buffer);
        note_host(received.host_present);
        if (received.bytes == 0) {
            co_await port_->news();
            continue;
        }
        // The line takes its time in this direction too; this also bounds what a host that writes
        // without end can cost.
        const auto byte_time = std::chrono::nanoseconds(10s) / emulator_.baud();
        line_time_.expires_after(byte_time * static_cast<std::int64_t>(received.bytes));
        co_await line_time_.async_wait(asio::use_awaitable);
        const auto moment = now();
        live_until(moment);
        emulator_.receive(std::span(buffer).first(received.bytes), moment, host_baud());
        next_step_.cancel();  // what is due next may have changed
    }
}

asio::awaitable<void> VirtualLidar::keep_pace() {
    while (true) {
        const auto moment = now();
        live_until(moment);
        report_losses(moment);
        const auto due = emulator_.next_due();
        next_step_.expires_at(due ? std::max(*due, moment + shortest_step) : Moment::max());
        boost::system::error_code ignored;  // cancelled: something to do sooner, or the end
        co_await next_step_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    }
}

void VirtualLidar::note_host(bool present) {
    if (present == host_present_) {
        return;
    }
    host_present_ = present;
    logger_->info("{} {}", port(), present ? "opened by a host" : "closed by the host");
    if (!present) {
        port_->clean_up_after_host(emulator_.baud());
    }
}

void VirtualLidar::live_until(Moment moment) {
    emulator_.advance(moment);
    emulator_.take(moment, transmitted_);
    for (const auto& transmitted : transmitted_) {
        deliver(transmitted);
    }
    transmitted_.clear();
}

// Bytes that nobody takes are gone, as on a UART.
void VirtualLidar::deliver(const Transmitted& transmitted) {
    if (!host_present_) {
        return;
    }
    const std::span sent(transmitted.bytes);
    const auto at = host_baud();
    if (!speeds_fit(emulator_.baud(), at)) {
        (void)port_->write_some(heard(sent, emulator_.baud(), at));
        return;
    }
    const auto written = port_->write_some(sent);
    lost_bytes_ += sent.size() - written;
    if (recording_ && transmitted.payload == Payload::measurement &&
        !recording_->append(sent.first(written))) {
        logger_->error("the recording ends here: it cannot be written any more");
        recording_.reset();
    }
}

std::uint32_t VirtualLidar::host_baud() const {
    return any_baud_ ? 0 : port_->host_baud();
}

void VirtualLidar::report_losses(Moment moment) {
    const auto lost = lost_bytes_ + emulator_.overrun_bytes();
    if (lost == reported_bytes_ || moment - reported_at_ < report_period) {
        return;
    }
    logger_->warn("{} the host does not read: {} bytes lost", port(), lost - reported_bytes_);
    reported_bytes_ = lost;
    reported_at_ = moment;
}

void VirtualLidar::log_event(const Event& event) {
    switch (event.what) {
    case Occurrence::motor_on:
        return logger_->info("{} motor on", port());
    case Occurrence::motor_off:
        return logger_->info("{} motor off", port());
    case Occurrence::scan_started:
        return logger_->info("{} scan started: {}", port(), event.mode->name);
    case Occurrence::scan_stopped:
        return logger_->info("{} scan stopped: {}", port(), event.mode->name);
    case Occurrence::reset:
        return logger_->info("{} reset", port());
    case Occurrence::protection_stop:
        return logger_->warn("{} protection stop", port());
    case Occurrence::played_out:
        return logger_->info("{} the capture has been played to its end", port());
    case Occurrence::baud_measured:
        return logger_->info("{} measured {} baud, on trial", port(), emulator_.baud());
    }
}

}  // namespace sweepcast::virtual_lidar
