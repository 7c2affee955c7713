// WireMessage: the bytes of one ServerMessage, framed for both transports once and shared by every
// client it goes to.
#pragma once

#include <google/protobuf/message_lite.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sweepcast::frame {

/// How a message is told from the next one on the way to a client.
enum class Framing : std::uint8_t {
    delimited,  ///< its length in front as a varint: TCP
    websocket,  ///< one unmasked binary frame, as a server sends it (RFC 6455, 5.2)
};

/// Bytes to be sent one after the other; `tail` may be empty.
struct FramedBytes {
    std::span<const std::uint8_t> head;
    std::span<const std::uint8_t> tail;

    [[nodiscard]] std::size_t size() const { return head.size() + tail.size(); }
    /// What is left after the first `sent` bytes.
    [[nodiscard]] FramedBytes after(std::size_t sent) const {
        return sent < head.size() ? FramedBytes{head.subspan(sent), tail}
                                  : FramedBytes{tail.subspan(sent - head.size()), {}};
    }
};

/// Immutable. Holds the message once, with what each framing puts in front of it.
class WireMessage {
public:
    explicit WireMessage(const google::protobuf::MessageLite& message);

    /// The message alone.
    [[nodiscard]] std::span<const std::uint8_t> message() const {
        return std::span(bytes_).subspan(header_);
    }
    /// What goes over the transport, as views of this message.
    [[nodiscard]] FramedBytes framed(Framing framing) const {
        if (framing == Framing::websocket) {
            return {bytes_, {}};
        }
        return {std::span(length_).first(length_size_), message()};
    }
    /// Bytes that it takes in memory, whatever the number of clients it waits for.
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }

private:
    std::vector<std::uint8_t> bytes_;  // a WebSocket frame
    std::size_t header_{};             // bytes of its header
    std::array<std::uint8_t, 5> length_{};
    std::uint8_t length_size_{};
};

using WireMessagePtr = std::shared_ptr<const WireMessage>;

}  // namespace sweepcast::frame
