// `sweepcast address`: shows and sets the address that a lidar has on its network.
#include "driver/device/advice.hpp"
#include "driver/device/error.hpp"
#include "driver/device/probe.hpp"
#include "driver/device/static_ip.hpp"
#include "driver/link/error.hpp"
#include "driver/link/open_link.hpp"
#include "driver/protocol/error.hpp"
#include "server/cli/address_wish.hpp"
#include "server/cli/command.hpp"
#include "server/cli/print.hpp"

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace sweepcast::cli {

namespace asio = boost::asio;
namespace json = boost::json;
using protocol::StaticIp;

namespace {

struct AddressArguments {
    std::string port;
    AddressTexts texts;
    bool json{};
};

/// What came of it.
struct Outcome {
    std::string model;
    std::string serial;
    StaticIp before;
    std::optional<StaticIp> wanted;  ///< none: it was only asked
    StaticIp now;

    [[nodiscard]] bool is_as_wanted() const { return !wanted || now == *wanted; }
};

Problem no_address(const error_code& failure, const std::string& model) {
    if (failure != protocol::errc::conf_not_supported) {
        return device::advice(failure);
    }
    return {
        failure,
        fmt::format("this lidar ({}) has no address of its own", model),
        "only models with a network port have one (S2E, T1); behind a bridge, set up the bridge"};
}

/// After a failed attempt to set: whether the address has changed is then open, unless the lidar
/// itself said no.
Problem not_set(const error_code& failure, const StaticIp& wanted) {
    if (failure == protocol::errc::conf_refused) {
        return {
            failure,
            fmt::format("the lidar refuses the address {}", dotted(wanted.address)),
            "it keeps the one that it has; try another"};
    }
    return {
        failure,
        fmt::format(
            "the lidar was told to be at {}, but does not confirm it: {}",
            dotted(wanted.address),
            failure.message()
        ),
        "switch it off and on, and look for it at the new address and at the old one"};
}

Problem differs(const Outcome& outcome) {
    return {
        make_error_code(protocol::errc::conf_refused),
        "the lidar accepted the address, but does not have it now",
        fmt::format(
            "it says ip {}, mask {}, gateway {}; try again, or another address",
            dotted(outcome.now.address),
            dotted(outcome.now.netmask),
            dotted(outcome.now.gateway)
        )};
}

asio::awaitable<Result<StaticIp, Problem>>
change(device::Conversation& talk, const StaticIp& before, const StaticIp& wanted) {
    if (auto problem = address_problem(wanted)) {
        co_return std::move(*problem);
    }
    if (wanted == before) {
        co_return before;
    }
    const auto set = co_await device::set_static_ip(talk, wanted);
    if (!set) {
        co_return not_set(set.error(), wanted);
    }
    const auto now = co_await device::read_static_ip(talk);
    if (!now) {
        co_return not_set(now.error(), wanted);
    }
    co_return *now;
}

asio::awaitable<Result<Outcome, Problem>>
show_or_set(asio::any_io_executor executor, link::LinkUrl url, AddressWish wish) {
    auto bauds = device::bauds_for(url, {});
    auto link = co_await link::open_link(executor, url, bauds.front());
    if (!link) {
        co_return link.error();
    }
    device::Conversation talk(**link);
    const auto probed = co_await device::probe_open(talk, std::move(url), std::move(bauds));
    if (!probed) {
        co_return probed.error();
    }
    const auto& identity = probed->identity;
    const auto model = device::shown_name(identity);
    const auto before = co_await device::read_static_ip(talk);
    if (!before) {
        co_return no_address(before.error(), model);
    }
    const auto serial = protocol::serial_text(identity.info.serial);
    Outcome outcome{model, serial, *before, {}, *before};
    if (wish.changes_nothing()) {
        co_return outcome;
    }
    outcome.wanted = wish.applied_to(*before);
    const auto now = co_await change(talk, *before, *outcome.wanted);
    if (!now) {
        co_return now.error();
    }
    outcome.now = *now;
    co_return outcome;
}

json::object to_json(const StaticIp& address) {
    return {
        {"ip", dotted(address.address)},
        {"mask", dotted(address.netmask)},
        {"gateway", dotted(address.gateway)}};
}

void print_json(const std::string& port, const Outcome& outcome) {
    json::object object{
        {"port", port},
        {"model", outcome.model},
        {"serial_number", outcome.serial},
        {"address", to_json(outcome.now)}};
    if (outcome.wanted) {
        object["before"] = to_json(outcome.before);
        object["restart_needed"] = outcome.now != outcome.before;
    }
    print_json_line(stdout, json::serialize(object));
}

/// A part of the address; with what it was before if something was set.
void print_part(const char* name, const Ipv4& before, const Ipv4& now, bool was_set) {
    if (was_set) {
        print(stdout, "{:<8}  {:<15}  {}\n", name, dotted(before), dotted(now));
    } else {
        print(stdout, "{:<8}  {}\n", name, dotted(now));
    }
}

/// Where the lidar will be found: the URL, if it is of the lidar itself.
std::string next_url(const link::LinkUrl& url, const StaticIp& address) {
    const auto* const place = std::get_if<link::UdpPlace>(&url.where);
    if (place == nullptr) {
        return dotted(address.address);
    }
    const bool usual = place->port == link::default_udp_port;
    return "udp://" + dotted(address.address) + (usual ? "" : ":" + std::to_string(place->port));
}

void print_text(const link::LinkUrl& url, const Outcome& outcome) {
    const auto& [model, serial, before, wanted, now] = outcome;
    print(stdout, "port      {}\nmodel     {}\nserial    {}\n", url.text, model, serial);
    if (wanted) {
        print(stdout, "{:<8}  {:<15}  {}\n", "", "before", "now");
    }
    print_part("ip", before.address, now.address, wanted.has_value());
    print_part("mask", before.netmask, now.netmask, wanted.has_value());
    print_part("gateway", before.gateway, now.gateway, wanted.has_value());
    if (!wanted || !outcome.is_as_wanted()) {
        return;
    }
    if (now == before) {
        print(stdout, "\nIt has this address already; nothing was changed.\n");
    } else {
        print(
            stdout,
            "\nThis takes effect when the lidar starts again: switch it off and on, then open {}\n",
            next_url(url, now)
        );
    }
}

int address(const AddressArguments& arguments) {
    const auto url = link::parse_link_url(arguments.port);
    if (!url) {
        return report_misuse(url.error());
    }
    const auto wish = parse_address_wish(arguments.texts);
    if (!wish) {
        return report_misuse(wish.error());
    }
    if (wish->is_whole()) {  // nothing of the lidar's is needed to see that it cannot work
        if (const auto problem = address_problem(wish->applied_to({}))) {
            return report_misuse(*problem);
        }
    }
    asio::io_context context;
    auto asked =
        asio::co_spawn(context, show_or_set(context.get_executor(), *url, *wish), asio::use_future);
    context.run();
    const auto outcome = asked.get();
    if (!outcome) {
        return report(outcome.error());
    }
    if (arguments.json) {
        print_json(arguments.port, *outcome);
    } else {
        print_text(*url, *outcome);
    }
    return outcome->is_as_wanted() ? 0 : report(differs(*outcome));
}

}  // namespace

void add_address_command(CLI::App& app, int& exit_code) {
    auto arguments = std::make_shared<AddressArguments>();
    auto& command = *app.add_subcommand(
        "address",
        "Show or set the IP address of a lidar with a network port (a running scan is ended)"
    );
    command
        .add_option("port", arguments->port, "udp://HOST[:PORT] of the lidar, or as probe takes it")
        ->required();
    command.add_option("--ip", arguments->texts.ip, "Its new address");
    command.add_option("--mask", arguments->texts.mask, "The mask of its network");
    command.add_option("--gateway", arguments->texts.gateway, "The router of its network");
    command.add_flag("--json", arguments->json, "Print a line of JSON");
    command.footer(
        "What is not given stays as it is. A new address takes effect when the lidar starts "
        "again.\n"
        "\n"
        "Examples:\n"
        "  sweepcast address udp://192.168.11.2\n"
        "  sweepcast address udp://192.168.11.2 --ip 192.168.11.7\n"
        "  sweepcast address udp://192.168.11.2 --ip 10.0.0.7 --mask 255.255.255.0 "
        "--gateway 10.0.0.1"
    );
    command.callback([arguments, &exit_code] { exit_code = address(*arguments); });
}

}  // namespace sweepcast::cli
