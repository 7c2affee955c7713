// `sweepcast probe`: says what is at a port.
#include "driver/device/probe.hpp"
#include "driver/protocol/model.hpp"
#include "driver/protocol/reply.hpp"
#include "server/cli/command.hpp"

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

void print(const std::string& port, const device::Identity& identity) {
    const auto& info = identity.info;
    fmt::print("port      {}\n", port);
    fmt::print("model     {}\n", protocol::model_name(info.model));
    fmt::print("serial    {}\n", protocol::serial_text(info.serial));
    fmt::print("firmware  {}.{:02}\n", info.firmware_major, info.firmware_minor);
    fmt::print("hardware  {}\n", info.hardware);
    fmt::print("health    {}", text(identity.health.status));
    fmt::print(
        "{}\n",
        identity.health.code != 0 ? fmt::format(", code {:#06x}", identity.health.code) : ""
    );
    for (const auto& mode : identity.modes) {
        fmt::print("mode      {}: {:.0f} samples/s\n", mode.name, mode.samples_per_second());
    }
}

int probe(const std::string& port, std::uint32_t baud) {
    asio::io_context context;
    auto asked = asio::co_spawn(
        context,
        device::probe(context.get_executor(), port, baud),
        asio::use_future
    );
    context.run();
    const auto identity = asked.get();
    if (!identity) {
        return report(identity.error());
    }
    print(port, *identity);
    return 0;
}

}  // namespace

void add_probe_command(CLI::App& app, int& exit_code) {
    struct Arguments {
        std::string port;
        std::uint32_t baud{device::default_baud};
    };
    auto arguments = std::make_shared<Arguments>();
    auto& command = *app.add_subcommand(
        "probe",
        "Say which lidar is at a port, if any (a running scan is ended)"
    );
    command.add_option("port", arguments->port, "The serial port, e.g. /dev/ttyUSB0")->required();
    command.add_option("--baud", arguments->baud, "Line speed in bits per second")
        ->capture_default_str();
    command.footer("Example:\n  sweepcast probe /dev/ttyUSB0");
    command.callback([arguments, &exit_code] {
        exit_code = probe(arguments->port, arguments->baud);
    });
}

}  // namespace sweepcast::cli
