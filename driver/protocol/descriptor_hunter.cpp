// Response descriptors: written, judged, and hunted for.
#include "driver/protocol/descriptor_hunter.hpp"

#include "driver/protocol/request.hpp"
#include "driver/protocol/wire.hpp"

#include <algorithm>

namespace sweepcast::protocol {
namespace {

constexpr std::uint8_t second_byte = 0x5A;
constexpr std::uint32_t length_mask = 0x3FFF'FFFF;
constexpr std::uint32_t many_bit = 1U << 30;
constexpr std::uint32_t reserved_bit = 1U << 31;

}  // namespace

std::array<std::uint8_t, descriptor_size> encode_descriptor(const Descriptor& descriptor) {
    std::array<std::uint8_t, descriptor_size> bytes{start_byte, second_byte};
    const auto mode = descriptor.many ? many_bit : 0U;
    store_le32(std::span(bytes).subspan<2, 4>(), (descriptor.length & length_mask) | mode);
    bytes[6] = descriptor.type;
    return bytes;
}

Expectation Expectation::reply(ReplyType type) {
    const auto lengths = [type]() -> std::array<std::uint32_t, 2> {
        switch (type) {
        case ReplyType::device_info:
            return {20, 20};
        case ReplyType::health:
            return {3, 3};
        case ReplyType::sample_rate:
            return {4, 4};
        case ReplyType::lidar_conf:
            return {4, max_packet_length};
        case ReplyType::set_lidar_conf:
            return {4, 8};  // old firmware left out the echoed type
        case ReplyType::acc_board_flag:
            return {4, 4};
        }
        return {1, 0};  // not a reply type: admits nothing
    }();
    Expectation expectation;
    expectation.forms_[0] = {static_cast<std::uint8_t>(type), false, lengths[0], lengths[1]};
    expectation.count_ = 1;
    return expectation;
}

Expectation Expectation::measurement() {
    Expectation expectation;
    for (const auto type :
         {AnswerType::normal,
          AnswerType::express,
          AnswerType::hq,
          AnswerType::ultra,
          AnswerType::dense,
          AnswerType::ultra_dense}) {
        const auto length = static_cast<std::uint32_t>(packet_size(type));
        expectation
            .forms_[expectation.count_++] = {static_cast<std::uint8_t>(type), true, length, length};
    }
    return expectation;
}

bool Expectation::admits(const Descriptor& descriptor) const {
    return std::any_of(forms_.begin(), forms_.begin() + count_, [&](const Form& form) {
        return descriptor.type == form.type && descriptor.many == form.many &&
               descriptor.length >= form.min_length && descriptor.length <= form.max_length;
    });
}

DescriptorHunter::Step DescriptorHunter::push(std::span<const std::uint8_t> bytes) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        window_[filled_++] = bytes[i];
        while (filled_ > 0 && !plausible()) {
            drop_first();
        }
        if (filled_ == descriptor_size) {
            filled_ = 0;
            return {i + 1, descriptor_in_window()};
        }
    }
    return {bytes.size(), std::nullopt};
}

/// Whether what the window holds can be (the beginning of) an expected descriptor.
bool DescriptorHunter::plausible() const {
    if (window_[0] != start_byte || (filled_ > 1 && window_[1] != second_byte)) {
        return false;
    }
    if (filled_ < descriptor_size) {
        return true;
    }
    const bool reserved_mode = (window_[5] & (reserved_bit >> 24)) != 0;
    return !reserved_mode && expectation_.admits(descriptor_in_window());
}

Descriptor DescriptorHunter::descriptor_in_window() const {
    const auto length_and_mode = load_le32(std::span(window_).subspan<2, 4>());
    return {length_and_mode & length_mask, (length_and_mode & many_bit) != 0, window_[6]};
}

void DescriptorHunter::drop_first() {
    std::shift_left(window_.begin(), window_.end(), 1);
    --filled_;
    ++skipped_;
}

}  // namespace sweepcast::protocol
