// Serialises a message behind its length, into memory of exactly the right size.
#include "server/frame/wire_message.hpp"

#include "server/frame/message_framing.hpp"

#include <limits>
#include <stdexcept>

namespace sweepcast::frame {

WireMessage::WireMessage(const google::protobuf::MessageLite& message) {
    const std::size_t size = message.ByteSizeLong();
    if (size > std::size_t{std::numeric_limits<std::int32_t>::max()}) {
        throw std::length_error("a message beyond protobuf's limit of 2 GiB");
    }
    constexpr std::size_t longest_prefix = 5;
    bytes_.reserve(size + longest_prefix);
    append_length(bytes_, static_cast<std::uint32_t>(size));
    prefix_ = bytes_.size();
    bytes_.resize(prefix_ + size);
    message.SerializeWithCachedSizesToArray(bytes_.data() + prefix_);
}

}  // namespace sweepcast::frame
