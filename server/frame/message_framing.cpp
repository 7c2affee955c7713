// Varint lengths, written and read.
#include "server/frame/message_framing.hpp"

#include "server/frame/error.hpp"

#include <limits>
#include <stdexcept>

namespace sweepcast::frame {

namespace {

constexpr std::size_t longest_length = 5;  // bytes of a varint of 32 bits
constexpr unsigned bits_per_byte = 7;
constexpr std::uint8_t more_follows = 0x80;

struct Length {
    std::size_t value{};
    std::size_t size{};  // bytes of the varint itself
};

/// Reads the varint at the front of `bytes`; none if it is not complete.
Result<std::optional<Length>>
read_length(std::span<const std::uint8_t> bytes, std::uint32_t longest) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        if (i == longest_length) {
            return error_code(errc::length_malformed);
        }
        const std::uint8_t byte = bytes[i];
        value |= std::uint64_t{byte & 0x7FU} << (bits_per_byte * i);
        if (value > longest) {  // what follows can only make it longer
            return error_code(errc::message_too_long);
        }
        if ((byte & more_follows) == 0) {
            if (byte == 0 && i > 0) {
                return error_code(errc::length_malformed);  // padded: no encoder writes that
            }
            return std::optional(Length{static_cast<std::size_t>(value), i + 1});
        }
    }
    return std::optional<Length>{};
}

}  // namespace

void append_length(std::vector<std::uint8_t>& out, std::uint32_t length) {
    while (length >= more_follows) {
        out.push_back(static_cast<std::uint8_t>(length | more_follows));
        length >>= bits_per_byte;
    }
    out.push_back(static_cast<std::uint8_t>(length));
}

void append_delimited(std::vector<std::uint8_t>& out, std::span<const std::uint8_t> message) {
    if (message.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw std::length_error("a message of 4 GiB");
    }
    append_length(out, static_cast<std::uint32_t>(message.size()));
    out.insert(out.end(), message.begin(), message.end());
}

void DelimitedReader::push(std::span<const std::uint8_t> bytes) {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(consumed_));
    consumed_ = 0;
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

Result<std::optional<std::span<const std::uint8_t>>> DelimitedReader::next() {
    using Message = std::optional<std::span<const std::uint8_t>>;
    const auto unread = std::span<const std::uint8_t>(buffer_).subspan(consumed_);
    const auto length = read_length(unread, longest_);
    if (!length) {
        return length.error();
    }
    if (!*length || unread.size() - (*length)->size < (*length)->value) {
        return Message{};
    }
    consumed_ += (*length)->size + (*length)->value;
    return Message(unread.subspan((*length)->size, (*length)->value));
}

}  // namespace sweepcast::frame
