#include "server/stream/messages.hpp"

#include "server/frame/dictionary.hpp"
#include "server/stream/lidar_message.hpp"
#include "server/version.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <fmt/format.h>

namespace sweepcast::stream {

namespace {

frame::WireMessagePtr wire(const v1::ServerMessage& message) {
    return std::make_shared<const frame::WireMessage>(message);
}

std::string known_ids(const hub::LocalHub& hub) {
    std::string ids;
    for (const auto& lidar : hub.lidars()) {
        if (lidar) {
            ids += (ids.empty() ? "" : ", ") + lidar->id;
        }
    }
    return ids.empty() ? "there is no lidar yet" : "the lidars are: " + ids;
}

/// The wish's lidar from an id; empty means all.
Result<std::optional<std::uint32_t>, Refusal>
lidar_number(std::string_view id, const hub::LocalHub& hub) {
    if (id.empty()) {
        return std::optional<std::uint32_t>{};
    }
    const auto lidar = hub.find(id);
    if (!lidar) {
        return Refusal{"lidar_not_found", fmt::format("no lidar \"{}\"", id), known_ids(hub)};
    }
    return std::optional<std::uint32_t>{lidar->number};
}

}  // namespace

frame::WireMessagePtr hello_message(const hub::LocalHub& hub) {
    v1::ServerMessage message;
    auto& hello = *message.mutable_hello();
    hello.set_protocol_version(protocol_version);
    hello.set_server(fmt::format("sweepcast {}", version));
    for (const auto& lidar : hub.lidars()) {
        if (lidar) {
            to_message(*lidar, *hello.add_lidars());
        }
    }
    auto& dictionary = *hello.add_dictionaries();
    dictionary.set_id(frame::dictionary_id());
    dictionary.set_size(static_cast<std::uint32_t>(frame::dictionary_bytes().size()));
    return wire(message);
}

frame::WireMessagePtr state_message(const hub::LidarSnapshot& lidar) {
    v1::ServerMessage message;
    to_message(lidar, *message.mutable_lidar());
    return wire(message);
}

frame::WireMessagePtr stats_message(const hub::OutboxCounts& counts) {
    v1::ServerMessage message;
    message.mutable_stats()->set_frames_sent(counts.frames_sent);
    message.mutable_stats()->set_frames_dropped(counts.frames_dropped);
    return wire(message);
}

frame::WireMessagePtr refusal_message(const Refusal& refusal) {
    v1::ServerMessage message;
    message.mutable_error()->set_code(refusal.code);
    message.mutable_error()->set_message(refusal.message);
    message.mutable_error()->set_hint(refusal.hint);
    return wire(message);
}

frame::WireMessagePtr closing_message(std::string_view reason) {
    v1::ServerMessage message;
    message.mutable_closing()->set_reason(std::string(reason));
    return wire(message);
}

Result<hub::Wish, Refusal> wish_from_message(std::string_view bytes, const hub::LocalHub& hub) {
    v1::ClientMessage message;
    if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) ||
        !message.has_subscribe()) {
        return Refusal{
            "bad_message",
            "this is not a ClientMessage with a subscribe in it",
            "send sweepcast.v1.ClientMessage; on TCP with its length in front as a varint"};
    }
    const auto& subscribe = message.subscribe();
    if (subscribe.kind() != v1::SWEEP) {
        return Refusal{"unknown_kind", fmt::format("no kind {}", subscribe.kind()), "kinds: SWEEP"};
    }
    hub::Wish wish;
    switch (subscribe.compression()) {
    case v1::ZSTD:
        wish.compression = frame::Compression::zstd;
        break;
    case v1::NONE:
        wish.compression = frame::Compression::none;
        break;
    default:
        return Refusal{
            "unknown_compression",
            fmt::format("no compression {}", subscribe.compression()),
            "compressions: ZSTD, NONE"};
    }
    const auto number = lidar_number(subscribe.lidar(), hub);
    if (!number) {
        return number.error();
    }
    wish.lidar = *number;
    return wish;
}

Result<hub::Wish, Refusal> wish_from_query(const Query& query, const hub::LocalHub& hub) {
    hub::Wish wish;
    for (const auto& [key, value] : query) {
        if (key == "lidar") {
            const auto number = lidar_number(value, hub);
            if (!number) {
                return number.error();
            }
            wish.lidar = *number;
        } else if (key == "kind" && value != "sweep") {
            return Refusal{"unknown_kind", fmt::format("no kind \"{}\"", value), "kinds: sweep"};
        } else if (key == "compression" && value == "none") {
            wish.compression = frame::Compression::none;
        } else if (key == "compression" && value != "zstd") {
            return Refusal{
                "unknown_compression",
                fmt::format("no compression \"{}\"", value),
                "compressions: zstd, none"};
        } else if (key != "kind" && key != "compression") {
            return Refusal{
                "unknown_parameter",
                fmt::format("no parameter \"{}\"", key),
                "parameters: lidar, kind, compression"};
        }
    }
    return wish;
}

}  // namespace sweepcast::stream
