// What the gateway says on a stream, and what it understands of a client. Pure: no socket, no
// clock.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/frame/wire_message.hpp"
#include "server/hub/local_hub.hpp"
#include "server/hub/outbox.hpp"
#include "server/hub/publication.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepcast::stream {

/// Version of the conversation, told in Hello.
constexpr std::uint32_t protocol_version = 1;
/// Longest message a client may send; a Subscribe has some dozens of bytes.
constexpr std::size_t longest_client_message = 4096;

/// An answer to a client that asked for something impossible; `code` is stable, for programs.
struct Refusal {
    std::string code;
    std::string message;
    std::string hint;
};

[[nodiscard]] frame::WireMessagePtr hello_message(const hub::LocalHub& hub);
[[nodiscard]] frame::WireMessagePtr state_message(const hub::LidarSnapshot& lidar);
[[nodiscard]] frame::WireMessagePtr stats_message(const hub::OutboxCounts& counts);
[[nodiscard]] frame::WireMessagePtr refusal_message(const Refusal& refusal);
[[nodiscard]] frame::WireMessagePtr closing_message(std::string_view reason);

/// Reads a ClientMessage. `bytes` is hostile.
[[nodiscard]] Result<hub::Wish, Refusal>
wish_from_message(std::string_view bytes, const hub::LocalHub& hub);

/// The decoded parameters of a URL's query, in order.
using Query = std::vector<std::pair<std::string, std::string>>;

/// Reads the query of a WebSocket URL, such as "lidar=A0E1C2D3&kind=sweep&compression=none". An
/// empty or missing lidar means all. An unknown parameter is refused: a misspelt wish should not be
/// taken for none.
[[nodiscard]] Result<hub::Wish, Refusal>
wish_from_query(const Query& query, const hub::LocalHub& hub);

}  // namespace sweepcast::stream
