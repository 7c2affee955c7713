// WireMessage: the bytes of one ServerMessage, made once and shared by every client it goes to.
#pragma once

#include <google/protobuf/message_lite.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sweepcast::frame {

/// Immutable. Holds the message with its length in front, so that both transports send from the
/// same bytes.
class WireMessage {
public:
    explicit WireMessage(const google::protobuf::MessageLite& message);

    /// With the length as a varint in front: what goes over TCP.
    [[nodiscard]] std::span<const std::uint8_t> delimited() const { return bytes_; }
    /// The message alone: what goes over WebSocket.
    [[nodiscard]] std::span<const std::uint8_t> message() const {
        return delimited().subspan(prefix_);
    }

private:
    std::vector<std::uint8_t> bytes_;
    std::size_t prefix_{};
};

using WireMessagePtr = std::shared_ptr<const WireMessage>;

}  // namespace sweepcast::frame
