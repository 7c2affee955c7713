#include "server/stream/messages.hpp"

#include "driver/protocol/printable.hpp"
#include "server/frame/dictionary.hpp"
#include "server/stream/lidar_message.hpp"
#include "server/version.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <fmt/format.h>

#include <utility>

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

/// The order in `subscribe`, which is hostile.
Result<Order, Refusal> order_from(v1::Subscribe subscribe, const hub::LocalHub& hub) {
    hub::Wish wish;
    if (!subscribe.lidar().empty()) {
        const auto lidar = hub.find(subscribe.lidar());
        if (!lidar) {
            return Refusal{
                "lidar_not_found",
                fmt::format("no lidar \"{}\"", subscribe.lidar()),
                known_ids(hub),
                subscribe.request()};
        }
        wish.lidar = lidar->number;
        subscribe.set_lidar(protocol::printable(lidar->id));
    }
    auto frames = frame_wish(subscribe);
    if (!frames) {
        auto refusal = frames.error();
        refusal.request = subscribe.request();
        return refusal;
    }
    wish.frames = std::move(*frames);
    v1::ServerMessage answer;
    const auto request = subscribe.request();
    *answer.mutable_subscribed()->mutable_wish() = std::move(subscribe);
    return Order{std::move(wish), wire(answer), request};
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
    message.mutable_error()->set_request(refusal.request);
    return wire(message);
}

frame::WireMessagePtr closing_message(std::string_view reason) {
    v1::ServerMessage message;
    message.mutable_closing()->set_reason(std::string(reason));
    return wire(message);
}

Refusal too_many_wishes(std::uint32_t request) {
    return {
        "too_many_wishes",
        fmt::format("subscribers already have {} distinct requests", hub::Variants::most),
        "request kind=sweep and nothing else: that is always served; or try again when other "
        "subscribers have left",
        request};
}

Result<Order, Refusal> order_from_message(std::string_view bytes, const hub::LocalHub& hub) {
    v1::ClientMessage message;
    if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) ||
        message.message_case() == v1::ClientMessage::MESSAGE_NOT_SET) {
        return Refusal{
            "bad_message",
            "this is not a ClientMessage with a subscribe or unsubscribe in it",
            "send sweepcast.v1.ClientMessage; on TCP with its length in front as a varint"};
    }
    if (message.has_unsubscribe()) {
        return Order{};
    }
    return order_from(std::move(*message.mutable_subscribe()), hub);
}

Result<Order, Refusal> order_from_query(const Query& query, const hub::LocalHub& hub) {
    auto subscribe = subscribe_from_query(query);
    if (!subscribe) {
        return subscribe.error();
    }
    return order_from(std::move(*subscribe), hub);
}

}  // namespace sweepcast::stream
