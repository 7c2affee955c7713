// Messages of a given size to fill mailboxes with.
#pragma once

#include "server/frame/wire_message.hpp"
#include "sweepcast/v1/stream.pb.h"

#include <string>

namespace sweepcast::hub {

/// A message that holds `text`.
inline frame::WireMessagePtr message(const std::string& text) {
    v1::ServerMessage server_message;
    server_message.mutable_closing()->set_reason(text);
    return std::make_shared<const frame::WireMessage>(server_message);
}

/// The text of such a message; "(none)" for null.
inline std::string text(const frame::WireMessagePtr& wire) {
    if (!wire) {
        return "(none)";
    }
    v1::ServerMessage server_message;
    const auto bytes = wire->message();
    server_message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
    return server_message.closing().reason();
}

}  // namespace sweepcast::hub
