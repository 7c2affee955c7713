// The address that a user wants a lidar to have: read from text, completed, checked.
#pragma once

#include "driver/protocol/lidar_conf.hpp"
#include "driver/protocol/result.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace sweepcast::cli {

using Ipv4 = std::array<std::uint8_t, 4>;

/// The parts as the user wrote them; empty: as they are.
struct AddressTexts {
    std::string ip, mask, gateway;
};

/// What is to become of an address; a part without a value stays as it is.
struct AddressWish {
    std::optional<Ipv4> ip, mask, gateway;

    [[nodiscard]] bool changes_nothing() const { return !ip && !mask && !gateway; }
    [[nodiscard]] bool is_whole() const { return ip && mask && gateway; }
    [[nodiscard]] protocol::StaticIp applied_to(const protocol::StaticIp& present) const;
};

/// Reads the parts, each "A.B.C.D". The Problem names the option that is wrong.
[[nodiscard]] Result<AddressWish, Problem> parse_address_wish(const AddressTexts& texts);

/// Why a lidar could not be reached at this address, or not by its gateway; none if it is sound.
[[nodiscard]] std::optional<Problem> address_problem(const protocol::StaticIp& address);

/// "192.168.11.2".
[[nodiscard]] std::string dotted(const Ipv4& address);

}  // namespace sweepcast::cli
