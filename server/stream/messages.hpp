// What the gateway says on a stream, and what it understands of a client. Pure: no socket, no
// clock.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/frame/wire_message.hpp"
#include "server/hub/local_hub.hpp"
#include "server/hub/outbox.hpp"
#include "server/hub/publication.hpp"
#include "server/stream/refusal.hpp"
#include "server/stream/subscribe_wish.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sweepcast::stream {

/// Version of the conversation, told in Hello.
constexpr std::uint32_t protocol_version = 1;
/// Longest message a client may send; a Subscribe has some dozens of bytes.
constexpr std::size_t longest_client_message = 4096;

/// What a client asked for.
struct Order {
    /// None: states only.
    std::optional<hub::Wish> wish;
    /// What it is told before the first frame; may be null.
    frame::WireMessagePtr answer;
    /// As the client numbered it; 0: it did not.
    std::uint32_t request{};
};

[[nodiscard]] frame::WireMessagePtr hello_message(const hub::LocalHub& hub);
[[nodiscard]] frame::WireMessagePtr state_message(const hub::LidarSnapshot& lidar);
[[nodiscard]] frame::WireMessagePtr stats_message(const hub::OutboxCounts& counts);
[[nodiscard]] frame::WireMessagePtr refusal_message(const Refusal& refusal);
[[nodiscard]] frame::WireMessagePtr closing_message(std::string_view reason);

/// Returns the refusal of one distinct request too many.
[[nodiscard]] Refusal too_many_wishes(std::uint32_t request);

/// Reads a ClientMessage. `bytes` is hostile.
[[nodiscard]] Result<Order, Refusal>
order_from_message(std::string_view bytes, const hub::LocalHub& hub);

/// Reads the query of a WebSocket URL, such as "lidar=A0E1C2D3&kind=sweep&compression=none". An
/// empty or missing lidar means all.
[[nodiscard]] Result<Order, Refusal> order_from_query(const Query& query, const hub::LocalHub& hub);

}  // namespace sweepcast::stream
