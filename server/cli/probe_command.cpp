// `sweepcast probe`: says what is at a port.
#include "driver/device/probe.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/reply.hpp"
#include "server/cli/command.hpp"
#include "server/cli/print.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <fmt/format.h>

#include <memory>
#include <string>

namespace sweepcast::cli {

namespace asio = boost::asio;

namespace {

const char* text(protocol::HealthStatus status) {
    switch (status) {
    case protocol::HealthStatus::good:
        return "good";
    case protocol::HealthStatus::warning:
        return "warning (it still works)";
    case protocol::HealthStatus::error:
        return "protection stop";
    }
    return "unknown";
}

void print_probed(const std::string& port, const device::Probed& probed) {
    const auto& identity = probed.identity;
    const auto& info = identity.info;
    print(stdout, "port      {}\n", port);
    print(
        stdout,
        "baud      {}\n",
        probed.baud > 0 ? std::to_string(probed.baud) : "none, a network"
    );
    print(stdout, "model     {}\n", device::shown_name(identity));
    print(stdout, "serial    {}\n", protocol::serial_text(info.serial));
    print(stdout, "firmware  {}.{:02}\n", info.firmware_major, info.firmware_minor);
    print(stdout, "hardware  {}\n", info.hardware);
    print(stdout, "health    {}", text(identity.health.status));
    print(
        stdout,
        "{}\n",
        identity.health.code != 0 ? fmt::format(", code {:#06x}", identity.health.code) : ""
    );
    for (const auto& mode : identity.modes) {
        print(
            stdout,
            "mode      {}: {:.0f} samples/s{}{}\n",
            mode.name,
            mode.samples_per_second(),
            mode.max_distance_mm > 0 ? fmt::format(", {:.0f} m", mode.max_distance_mm / 1000) : "",
            mode.typical ? ", recommended" : ""
        );
    }
}

int probe(const std::string& port) {
    auto url = link::parse_link_url(port);
    if (!url) {
        return report_misuse(url.error());
    }
    asio::io_context context;
    auto asked = asio::co_spawn(
        context,
        device::probe(context.get_executor(), std::move(*url), {}),
        asio::use_future
    );
    context.run();
    const auto probed = asked.get();
    if (!probed) {
        return report(probed.error());
    }
    print_probed(port, *probed);
    return 0;
}

}  // namespace

void add_probe_command(CLI::App& app, int& exit_code) {
    auto port = std::make_shared<std::string>();
    auto& command = *app.add_subcommand(
        "probe",
        "Say which lidar is at a port, if any (a running scan is ended)"
    );
    command
        .add_option(
            "port",
            *port,
            "A serial port (its line speed is found out, or ?baud=N), tcp://HOST or udp://HOST"
        )
        ->required();
    command.footer(
        "Examples:\n"
        "  sweepcast probe /dev/ttyUSB0\n"
        "  sweepcast probe '/dev/ttyUSB0?baud=256000'\n"
        "  sweepcast probe udp://192.168.11.2"
    );
    command.callback([port, &exit_code] { exit_code = probe(*port); });
}

}  // namespace sweepcast::cli
