#include "driver/virtual/uart.hpp"

#include "driver/link/termios2.hpp"

#include <cstddef>

namespace sweepcast::virtual_lidar {

namespace {

constexpr std::uint64_t bits_per_byte = 10;

// The level of the line over time. Times are in units in which a bit of the sender takes
// `heard_baud` and a bit of the receiver `sent_baud`.
class Waveform {
public:
    Waveform(std::span<const std::uint8_t> bytes, std::uint64_t sender_bit)
        : bytes_(bytes)
        , sender_bit_(sender_bit) {}

    [[nodiscard]] std::uint64_t end() const { return bytes_.size() * bits_per_byte * sender_bit_; }

    [[nodiscard]] bool is_high(std::uint64_t time) const { return bit(time / sender_bit_); }

    // The first moment from `time` on at which the line is or becomes low or high; end() if there
    // is none.
    [[nodiscard]] std::uint64_t next(bool high, std::uint64_t time) const {
        for (auto index = time / sender_bit_; index < bytes_.size() * bits_per_byte; ++index) {
            if (bit(index) == high) {
                return index * sender_bit_ > time ? index * sender_bit_ : time;
            }
        }
        return end();
    }

private:
    // After the last byte the line rests, which is high.
    [[nodiscard]] bool bit(std::uint64_t index) const {
        const auto in_byte = index % bits_per_byte;
        const auto byte = static_cast<std::size_t>(index / bits_per_byte);
        if (byte >= bytes_.size() || in_byte == bits_per_byte - 1) {
            return true;
        }
        return in_byte != 0 && ((bytes_[byte] >> (in_byte - 1)) & 1) != 0;
    }

    std::span<const std::uint8_t> bytes_;
    std::uint64_t sender_bit_;
};

}  // namespace

bool speeds_fit(std::uint32_t sent_baud, std::uint32_t heard_baud) {
    return sent_baud == 0 || heard_baud == 0 || link::close_enough(sent_baud, heard_baud);
}

std::vector<std::uint8_t>
heard(std::span<const std::uint8_t> bytes, std::uint32_t sent_baud, std::uint32_t heard_baud) {
    if (speeds_fit(sent_baud, heard_baud)) {
        return {bytes.begin(), bytes.end()};
    }
    const std::uint64_t receiver_bit = sent_baud;
    const Waveform line(bytes, heard_baud);
    std::vector<std::uint8_t> received;
    for (auto time = line.next(false, 0); time < line.end(); time = line.next(false, time)) {
        const auto middle = time + receiver_bit / 2;  // of the start bit
        std::uint8_t byte = 0;
        for (unsigned i = 0; i < 8; ++i) {
            byte |= static_cast<std::uint8_t>(line.is_high(middle + (i + 1) * receiver_bit) << i);
        }
        received.push_back(byte);
        time = line.next(true, middle + 9 * receiver_bit);
    }
    return received;
}

}  // namespace sweepcast::virtual_lidar
