// CRC-32 by tables, eight bytes a step: a packet's checksum costs more than all its samples.
#include "driver/protocol/crc32.hpp"

#include "driver/protocol/wire.hpp"

#include <array>
#include <cstddef>

namespace sweepcast::protocol {
namespace {

constexpr std::size_t step = 8;
using Tables = std::array<std::array<std::uint32_t, 256>, step>;

/// Table k holds what a byte does to the sum when k more zero bytes follow it.
constexpr Tables make_tables() {
    Tables tables{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t sum = byte;
        for (int bit = 0; bit < 8; ++bit) {
            sum = (sum >> 1) ^ ((sum & 1U) != 0 ? 0xEDB88320U : 0U);
        }
        tables[0][byte] = sum;
    }
    for (std::size_t k = 1; k < step; ++k) {
        for (std::size_t byte = 0; byte < 256; ++byte) {
            const auto sum = tables[k - 1][byte];
            tables[k][byte] = (sum >> 8) ^ tables[0][sum & 0xFFU];
        }
    }
    return tables;
}

constexpr Tables tables = make_tables();

}  // namespace

std::uint32_t crc32_padded(std::span<const std::uint8_t> bytes) {
    const auto padding = 4 - bytes.size() % 4;
    std::uint32_t sum = 0xFFFFFFFFU;
    for (; bytes.size() >= step; bytes = bytes.subspan(step)) {
        const auto low = sum ^ load_le32(bytes.first<4>());
        const auto high = load_le32(bytes.subspan<4, 4>());
        sum = tables[7][low & 0xFFU] ^ tables[6][low >> 8 & 0xFFU] ^ tables[5][low >> 16 & 0xFFU] ^
              tables[4][low >> 24] ^ tables[3][high & 0xFFU] ^ tables[2][high >> 8 & 0xFFU] ^
              tables[1][high >> 16 & 0xFFU] ^ tables[0][high >> 24];
    }
    for (const auto byte : bytes) {
        sum = (sum >> 8) ^ tables[0][(sum ^ byte) & 0xFFU];
    }
    for (std::size_t i = 0; i < padding; ++i) {
        sum = (sum >> 8) ^ tables[0][sum & 0xFFU];
    }
    return ~sum;
}

}  // namespace sweepcast::protocol
