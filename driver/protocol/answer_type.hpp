// The types of answers: measurement streams with the size of their packets, and single replies.
#pragma once

#include <cstddef>
#include <cstdint>

namespace sweepcast::protocol {

/// The type byte of the descriptor that opens a measurement stream (protocol.md 1.3).
enum class AnswerType : std::uint8_t {
    normal = 0x81,       ///< 5 bytes, 1 sample
    express = 0x82,      ///< 84 bytes, 32 samples
    hq = 0x83,           ///< 781 bytes, 96 samples
    ultra = 0x84,        ///< 132 bytes, 96 samples
    dense = 0x85,        ///< 84 bytes, 40 samples
    ultra_dense = 0x86,  ///< 170 bytes, 64 samples
};

/// The type byte of the descriptor that opens an answer of one packet (protocol.md 1.3).
enum class ReplyType : std::uint8_t {
    device_info = 0x04,
    health = 0x06,
    sample_rate = 0x15,
    lidar_conf = 0x20,
    set_lidar_conf = 0x21,
    acc_board_flag = 0xFF,
};

/// Bytes of one packet of a measurement stream; 0 for a value that is no answer type.
[[nodiscard]] constexpr std::size_t packet_size(AnswerType type) {
    switch (type) {
    case AnswerType::normal:
        return 5;
    case AnswerType::express:
        return 84;
    case AnswerType::hq:
        return 781;
    case AnswerType::ultra:
        return 132;
    case AnswerType::dense:
        return 84;
    case AnswerType::ultra_dense:
        return 170;
    }
    return 0;
}

/// Samples in one such packet; 0 for a value that is no answer type.
[[nodiscard]] constexpr std::size_t samples_per_packet(AnswerType type) {
    switch (type) {
    case AnswerType::normal:
        return 1;
    case AnswerType::express:
        return 32;
    case AnswerType::hq:
    case AnswerType::ultra:
        return 96;
    case AnswerType::dense:
        return 40;
    case AnswerType::ultra_dense:
        return 64;
    }
    return 0;
}

}  // namespace sweepcast::protocol
