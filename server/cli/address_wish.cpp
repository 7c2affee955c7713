#include "server/cli/address_wish.hpp"

#include <boost/asio/ip/address_v4.hpp>
#include <boost/system/errc.hpp>
#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace sweepcast::cli {

namespace asio = boost::asio;

namespace {

Problem wrong(std::string cause, std::string hint) {
    return {
        make_error_code(boost::system::errc::invalid_argument),
        std::move(cause),
        std::move(hint)};
}

/// One part; none if `text` is empty.
Result<std::optional<Ipv4>, Problem>
parse_part(std::string_view option, std::string_view example, const std::string& text) {
    if (text.empty()) {
        return std::optional<Ipv4>();
    }
    error_code failed;
    const auto address = asio::ip::make_address_v4(text, failed);
    if (failed) {
        return wrong(
            fmt::format("{} {} is not four numbers from 0 to 255", option, text),
            fmt::format("write it as {} {}", option, example)
        );
    }
    return std::optional<Ipv4>(address.to_bytes());
}

std::uint32_t number(const Ipv4& address) {
    return asio::ip::address_v4(address).to_uint();
}

std::string dotted(std::uint32_t address) {
    return asio::ip::address_v4(address).to_string();
}

std::optional<Problem> mask_problem(std::uint32_t mask) {
    const auto hosts = ~mask;
    if ((hosts & (hosts + 1)) != 0) {
        return wrong(
            fmt::format("the mask {} is not ones followed by zeros", dotted(mask)),
            "the usual one is --mask 255.255.255.0"
        );
    }
    constexpr std::uint32_t fewest_hosts = 3;  // two, and the addresses of network and broadcast
    if (hosts < fewest_hosts || mask == 0) {
        return wrong(
            fmt::format("the mask {} makes no network that a lidar could be in", dotted(mask)),
            "the usual one is --mask 255.255.255.0"
        );
    }
    return std::nullopt;
}

/// Addresses that mean something else than one host anywhere: "this host", loopback, multicast and
/// what is reserved above it.
bool is_of_no_host(std::uint32_t ip) {
    const auto first = ip >> 24U;
    return first == 0 || first == 127 || first >= 224;
}

/// The network or the broadcast address; none if it is a host's.
std::optional<Problem>
border_problem(std::string_view option, std::uint32_t ip, std::uint32_t mask) {
    const auto network = ip & mask;
    const auto broadcast = network | ~mask;
    if (ip != network && ip != broadcast) {
        return std::nullopt;
    }
    return wrong(
        fmt::format(
            "{} {} is the {} address of its network",
            option,
            dotted(ip),
            ip == network ? "network" : "broadcast"
        ),
        fmt::format("give one from {} to {}", dotted(network + 1), dotted(broadcast - 1))
    );
}

}  // namespace

protocol::StaticIp AddressWish::applied_to(const protocol::StaticIp& present) const {
    return {
        ip.value_or(present.address),
        mask.value_or(present.netmask),
        gateway.value_or(present.gateway)};
}

Result<AddressWish, Problem> parse_address_wish(const AddressTexts& texts) {
    const auto ip = parse_part("--ip", "192.168.11.2", texts.ip);
    if (!ip) {
        return ip.error();
    }
    const auto mask = parse_part("--mask", "255.255.255.0", texts.mask);
    if (!mask) {
        return mask.error();
    }
    const auto gateway = parse_part("--gateway", "192.168.11.1", texts.gateway);
    if (!gateway) {
        return gateway.error();
    }
    return AddressWish{*ip, *mask, *gateway};
}

std::optional<Problem> address_problem(const protocol::StaticIp& address) {
    const auto ip = number(address.address);
    const auto mask = number(address.netmask);
    const auto gateway = number(address.gateway);
    if (auto problem = mask_problem(mask)) {
        return problem;
    }
    if (is_of_no_host(ip)) {
        return wrong(
            fmt::format("--ip {} cannot be the address of a lidar", dotted(ip)),
            "give one of your own network, such as --ip 192.168.11.2"
        );
    }
    if (auto problem = border_problem("--ip", ip, mask)) {
        return problem;
    }
    if ((gateway & mask) != (ip & mask)) {
        return wrong(
            fmt::format(
                "the gateway {} is outside the network of {} with the mask {}",
                dotted(gateway),
                dotted(ip),
                dotted(mask)
            ),
            "give the router of that network with --gateway; without one, any free address in it"
        );
    }
    if (gateway == ip) {
        return wrong(
            fmt::format("{} would be both the lidar and its gateway", dotted(ip)),
            "give another address with --ip or --gateway"
        );
    }
    return border_problem("--gateway", gateway, mask);
}

std::string dotted(const Ipv4& address) {
    return asio::ip::address_v4(address).to_string();
}

}  // namespace sweepcast::cli
