#include "driver/virtual/virtual_lidar.hpp"

#include "driver/async/task_group.hpp"
#include "driver/virtual/error.hpp"
#include "driver/virtual/pty.hpp"
#include "driver/virtual/tcp_port.hpp"
#include "driver/virtual/trimmed.hpp"
#include "driver/virtual/uart.hpp"
#include "driver/virtual/udp_port.hpp"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/system/system_error.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

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

Result<FaultSchedule, Problem> schedule_of(const VirtualLidarOptions& options) {
    FaultSchedule schedule;
    for (const auto& text : options.schedule) {
        if (auto added = schedule.add(text); !added) {
            return std::move(added).error();
        }
    }
    return schedule;
}

// None if no file is asked for.
Result<std::optional<TruthFile>, Problem> truth_of(const VirtualLidarOptions& options) {
    if (options.truth.empty()) {
        return std::optional<TruthFile>();
    }
    auto file = TruthFile::create(options.truth);
    if (!file) {
        return std::move(file).error();
    }
    return std::optional(std::move(*file));
}

EmulatorSettings
with_hook(EmulatorSettings settings, std::function<void(const Measured&)> on_measured) {
    settings.on_measured = std::move(on_measured);
    return settings;
}

Problem not_now(std::string cause, std::string hint) {
    return {errc::not_now, std::move(cause), std::move(hint)};
}

Problem is_unplugged() {
    return not_now("it is unplugged", "plug it in first: replug");
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

// `listen` as in VirtualLidarOptions.
Result<std::unique_ptr<HostPort>, Problem> open_port(
    const asio::any_io_executor& executor,
    const std::string& listen,
    const Persona& persona
) {
    if (listen.empty()) {
        return as_host_port(Pty::open(executor, persona.baud));
    }
    const auto address = parse_listen_address(listen, persona.connection);
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
    bool on_network;
    bool any_baud;
    std::optional<PortLink> link;
    std::optional<Recording> recording;
    std::optional<TruthFile> truth;
    std::function<void(const Measured&)> on_measured;
    FaultSchedule schedule;
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
    auto schedule = schedule_of(options);
    if (!schedule) {
        return std::move(schedule).error();
    }
    auto playback = playback_of(options);
    if (!playback) {
        return std::move(playback).error();
    }
    const auto* const persona = *playback ? &(*playback)->persona() : find_persona(options.model);
    auto port = open_port(executor, options.listen, *persona);
    if (!port) {
        return std::move(port).error();
    }
    auto truth = truth_of(options);
    if (!truth) {
        return std::move(truth).error();
    }
    const BeamSettings beam{
        .noise_mm = options.noise_mm,
        .dropout = options.dropout,
        .seed = options.seed};
    Parts parts{
        .logger = std::move(logger),
        .executor = executor,
        .port = std::move(*port),
        .on_network = !options.listen.empty(),
        .any_baud = options.any_baud,
        .link = {},
        .recording = {},
        .truth = std::move(*truth),
        .on_measured = options.on_measured,
        .schedule = std::move(*schedule),
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
    std::unique_ptr<VirtualLidar> lidar(new VirtualLidar(std::move(parts)));
    if (!options.control.empty()) {
        auto control = ControlSocket::open(
            executor,
            options.control,
            [&lidar = *lidar](std::string_view line) { return lidar.obey_line(line); }
        );
        if (!control) {
            return std::move(control).error();
        }
        lidar->control_ = std::move(*control);
    }
    lidar->log_listening();
    return lidar;
}

VirtualLidar::VirtualLidar(Parts&& parts)
    : logger_(std::move(parts.logger))
    , executor_(parts.executor)
    , port_(std::move(parts.port))
    , address_(port_->address())
    , listen_(parts.on_network ? address_ : "")
    , any_baud_(parts.any_baud)
    , link_(std::move(parts.link))
    , link_path_(link_ ? link_->path() : "")
    , recording_(std::move(parts.recording))
    , truth_(std::move(parts.truth))
    , on_measured_(std::move(parts.on_measured))
    , playback_(std::move(parts.playback))
    , persona_(parts.persona)
    , faults_(parts.settings.faults)
    , schedule_(std::move(parts.schedule))
    , switched_on_(now())
    , emulator_(
          *parts.persona,
          parts.serial,
          std::move(parts.beam),
          switched_on_,
          [this](const Event& event) { log_event(event); },
          with_hook(
              parts.settings,
              truth_ || on_measured_ ? [this](const Measured& measured) { note_measured(measured); }
                                     : std::function<void(const Measured&)>()
          )
      )
    , plugged_in_(executor_)
    , next_step_(executor_)
    , line_time_(executor_)
    , stopped_(executor_, std::chrono::steady_clock::time_point::max()) {}

void VirtualLidar::log_listening() const {
    const auto linked = link_ ? " (link " + link_->path() + ")" : std::string();
    logger_->info(
        "{} listening on {}{}, serial {}",
        persona_->title,
        port(),
        linked,
        protocol::short_serial_text(emulator_.serial())
    );
}

Result<void, Problem> VirtualLidar::obey(const FaultCommand& command) {
    struct Obey {
        VirtualLidar& lidar;
        Result<void, Problem> operator()(const Unplug& /*command*/) { return lidar.unplug(); }
        Result<void, Problem> operator()(const Replug& told) { return lidar.replug(told.link); }
        Result<void, Problem> operator()(const SetFault& told) {
            auto faults = lidar.faults_;
            auto added = add_fault(faults, told.text);
            return added ? lidar.set_faults(faults) : added;
        }
        Result<void, Problem> operator()(const ClearFault& told) {
            auto faults = told.name.empty() ? Faults() : lidar.faults_;
            if (!told.name.empty()) {
                if (auto cleared = clear_fault(faults, told.name); !cleared) {
                    return cleared;
                }
            }
            return lidar.set_faults(faults);
        }
        Result<void, Problem> operator()(const Suffer& told) { return lidar.suffer(told); }
    };
    auto obeyed = std::visit(Obey{*this}, command);
    next_step_.cancel();  // what is due next may have changed
    return obeyed;
}

Result<void, Problem> VirtualLidar::unplug() {
    if (!port_) {
        return is_unplugged();
    }
    live_until(now());
    link_.reset();
    port_->close();
    port_.reset();
    host_present_ = false;
    logger_->info("{} unplugged", address_);
    return {};
}

Result<void, Problem> VirtualLidar::replug(const std::string& link) {
    if (port_) {
        return not_now("it is plugged in", "unplug it first: unplug");
    }
    if (!link.empty() && !listen_.empty()) {
        return invalid("only a pseudo terminal can have a link", "replug it without a path");
    }
    auto port = open_port(executor_, listen_, *persona_);
    if (!port) {
        return std::move(port).error();
    }
    const auto& path = link.empty() ? link_path_ : link;
    if (!path.empty()) {
        auto made = PortLink::create(path, (*port)->address());
        if (!made) {
            return std::move(made).error();
        }
        link_ = std::move(*made);
        link_path_ = link_->path();
    }
    port_ = std::move(*port);
    address_ = port_->address();
    ++replugs_;
    log_listening();
    emulator_.restart(faults_, now());
    plugged_in_.notify();
    return {};
}

Result<void, Problem> VirtualLidar::set_faults(const Faults& faults) {
    faults_ = faults;
    const auto text = faults_text(faults);
    logger_->info("{} faults: {}", address_, text.empty() ? "none" : text);
    if (port_) {
        const auto moment = now();
        live_until(moment);
        emulator_.set_faults(faults, moment);
        live_until(moment);
    }
    return {};
}

Result<void, Problem> VirtualLidar::suffer(const Suffer& command) {
    if (!port_) {
        return is_unplugged();
    }
    const auto moment = now();
    live_until(moment);
    if (!emulator_.suffer(command.incident, command.value, moment)) {
        return not_now("no scan is running", "start one, and say it again");
    }
    logger_->info("{} suffers: {}", address_, to_text(FaultCommand(command)));
    return {};
}

std::string VirtualLidar::obey_line(std::string_view line) {
    if (trimmed(line) == "status") {
        return "ok " + to_text(status());
    }
    const auto command = parse_fault_command(line);
    const auto obeyed = command ? obey(*command) : Result<void, Problem>(command.error());
    return obeyed ? "ok" : fmt::format("error: {}: {}", obeyed.error().cause, obeyed.error().hint);
}

void VirtualLidar::obey_schedule(Moment moment) {
    while (const auto command = schedule_.take_due(moment - switched_on_)) {
        if (const auto obeyed = obey(*command); !obeyed) {
            logger_->warn(
                "{} schedule: {}: {}: {}",
                address_,
                to_text(*command),
                obeyed.error().cause,
                obeyed.error().hint
            );
        }
    }
}

VirtualLidarStatus VirtualLidar::status() const {
    const auto* const mode = port_ ? emulator_.scan_mode() : nullptr;
    return {
        .port = address_,
        .plugged = is_plugged(),
        .host_present = host_present_,
        .scan_mode = mode != nullptr ? mode->name : "",
        .faults = faults_,
        .replugs = replugs_,
        .damage = emulator_.damage(),
        .unread_bytes = lost_bytes_ + emulator_.overrun_bytes(),
    };
}

std::string to_text(const VirtualLidarStatus& status) {
    const auto yes_or_no = [](bool yes) { return yes ? "yes" : "no"; };
    const auto faults = faults_text(status.faults);
    return fmt::format(
        "port={} plugged={} host={} scan={} faults={} replugs={} packets={} damaged={} "
        "undetectable={} unread_bytes={}",
        status.port,
        yes_or_no(status.plugged),
        yes_or_no(status.host_present),
        status.scan_mode.empty() ? "none" : status.scan_mode,
        faults.empty() ? "none" : faults,
        status.replugs,
        status.damage.packets,
        status.damage.damaged,
        status.damage.undetectable,
        status.unread_bytes
    );
}

void VirtualLidar::note_measured(const Measured& measured) {
    if (truth_ && !truth_->append(measured)) {
        logger_->error("the file of what was measured ends here: it cannot be written any more");
        truth_.reset();
    }
    if (on_measured_) {
        on_measured_(measured);
    }
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
    if (control_) {
        tasks.spawn(control_->run());
    }
    if (!stopping_) {
        boost::system::error_code ignored;  // how the wait ends makes no difference
        co_await stopped_.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
    }
    tasks.cancel();
    for (bool ended = false; !ended;) {
        ended = co_await tasks.join(1s);
    }
    control_.reset();
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
        const auto port = port_;  // it may be unplugged while this waits
        if (!port) {
            co_await plugged_in_.wait_until(Moment::max());
            continue;
        }
        const auto received = port->read_some(buffer);
        note_host(received.host_present);
        if (received.bytes == 0) {
            co_await wait_for_news(port);
            continue;
        }
        // The line takes its time in this direction too; this also bounds what a host that writes
        // without end can cost.
        const auto byte_time = std::chrono::nanoseconds(10s) / emulator_.baud();
        line_time_.expires_after(byte_time * static_cast<std::int64_t>(received.bytes));
        co_await line_time_.async_wait(asio::use_awaitable);
        if (port != port_) {
            continue;  // they were under way when it was unplugged
        }
        const auto moment = now();
        live_until(moment);
        emulator_.receive(std::span(buffer).first(received.bytes), moment, host_baud());
        next_step_.cancel();  // what is due next may have changed
    }
}

// Returns also when the port is closed.
asio::awaitable<void> VirtualLidar::wait_for_news(std::shared_ptr<HostPort> port) {
    try {
        co_await port->news();
    } catch (const boost::system::system_error&) {
        if (port == port_) {
            throw;
        }
    }
}

asio::awaitable<void> VirtualLidar::keep_pace() {
    while (true) {
        const auto moment = now();
        obey_schedule(moment);
        live_until(moment);
        flood();
        report_losses(moment);
        const auto due = next_due(moment);
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

// When there will be something to do next.
std::optional<Moment> VirtualLidar::next_due(Moment moment) const {
    auto due = port_ ? emulator_.next_due() : std::nullopt;
    if (const auto next = schedule_.next_due()) {
        due = std::min(due.value_or(Moment::max()), switched_on_ + *next);
    }
    return port_ && faults_.flood && host_present_ ? std::optional(moment) : due;
}

// As much as the port takes, in pieces so large that all others get their turn.
void VirtualLidar::flood() {
    constexpr std::size_t most = 64UL * 1024;
    if (!port_ || !faults_.flood || !host_present_) {
        return;
    }
    const auto piece = emulator_.flood_piece();
    for (std::size_t sent = 0; sent < most; sent += piece.size()) {
        if (port_->write_some(piece) < piece.size()) {
            return;
        }
    }
}

void VirtualLidar::live_until(Moment moment) {
    if (!port_) {
        return;  // without power
    }
    emulator_.advance(moment);
    emulator_.take(moment, transmitted_);
    for (const auto& transmitted : transmitted_) {
        deliver(transmitted);
    }
    transmitted_.clear();
    if (truth_) {
        (void)truth_->flush();  // the next append() tells
    }
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
    const auto baud = any_baud_ ? 0 : port_->host_baud();
    // Where the line has no speed the host stands for one who has set the model's.
    return baud == 0 && faults_.wrong_baud != 0 ? persona_->baud : baud;
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
    case Occurrence::restarted:
        return logger_->info("{} has its power again, and boots", port());
    case Occurrence::protection_stop:
        return logger_->warn("{} protection stop", port());
    case Occurrence::played_out:
        return logger_->info("{} the capture has been played to its end", port());
    case Occurrence::baud_measured:
        return logger_->info("{} measured {} baud, on trial", port(), emulator_.baud());
    }
}

}  // namespace sweepcast::virtual_lidar
