// Serialises a message behind its WebSocket header, into memory of exactly the right size.
#include "server/frame/wire_message.hpp"

#include "server/frame/message_framing.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace sweepcast::frame {

namespace {

/// The header of an unmasked binary frame that is a whole message. RFC 6455, 5.2.
void append_websocket_header(std::vector<std::uint8_t>& out, std::uint32_t size) {
    constexpr std::uint8_t final_binary = 0x82;
    constexpr std::uint32_t longest_in_seven_bits = 125;
    constexpr std::uint8_t sixteen_bits_follow = 126;
    constexpr std::uint8_t sixty_four_bits_follow = 127;
    out.push_back(final_binary);
    int more_bytes = 0;
    if (size <= longest_in_seven_bits) {
        out.push_back(static_cast<std::uint8_t>(size));
    } else if (size <= std::numeric_limits<std::uint16_t>::max()) {
        out.push_back(sixteen_bits_follow);
        more_bytes = 2;
    } else {
        out.push_back(sixty_four_bits_follow);
        more_bytes = 8;
    }
    for (int byte = more_bytes - 1; byte >= 0; --byte) {
        out.push_back(static_cast<std::uint8_t>(std::uint64_t{size} >> (8 * byte)));
    }
}

}  // namespace

WireMessage::WireMessage(const google::protobuf::MessageLite& message) {
    const std::size_t size = message.ByteSizeLong();
    if (size > std::size_t{std::numeric_limits<std::int32_t>::max()}) {
        throw std::length_error("a message beyond protobuf's limit of 2 GiB");
    }
    const auto length = static_cast<std::uint32_t>(size);
    std::vector<std::uint8_t> prefix;
    append_length(prefix, length);
    std::ranges::copy(prefix, length_.begin());
    length_size_ = static_cast<std::uint8_t>(prefix.size());

    constexpr std::size_t longest_header = 10;
    bytes_.reserve(size + longest_header);
    append_websocket_header(bytes_, length);
    header_ = bytes_.size();
    bytes_.resize(header_ + size);
    message.SerializeWithCachedSizesToArray(bytes_.data() + header_);
}

}  // namespace sweepcast::frame
