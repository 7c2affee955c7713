// What can be wrong with a frame or with the bytes that carry it.
#pragma once

#include "driver/protocol/result.hpp"

#include <cstdint>
#include <type_traits>

namespace sweepcast::frame {

enum class errc : std::uint8_t {
    length_malformed = 1,   ///< a length prefix is no varint, or a longer one than needed
    message_too_long,       ///< a length prefix announces more than is accepted
    compression_unknown,    ///< the frame names a compression that we do not know
    raw_size_out_of_range,  ///< the frame announces a bigger scan than there can be
    raw_size_wrong,         ///< the body is not of the size that the frame announces
    compression_damaged,    ///< the body does not decompress
    scan_malformed,         ///< the body is no Scan message
    too_many_samples,       ///< more samples than a scan can have
    column_length_wrong,    ///< a column has not one entry a sample
    unit_unknown,           ///< a unit of angle or distance that the schema does not name
    angle_out_of_range,     ///< an angle lies outside the circle, or a step is longer than it
    distance_out_of_range,  ///< a distance is negative, zero where an echo is said to be, or too
                            ///< far
    quality_out_of_range,   ///< a quality above 255
    flag_out_of_range,      ///< a flag above 255, or one for a sample that is not there
    answer_type_unknown,    ///< not one of 0x81 to 0x86
    dictionary_unknown,     ///< compressed with a dictionary that is not ours
};

/// The category of errc, "sweepcast.frame".
const boost::system::error_category& frame_category();

inline error_code make_error_code(errc value) {
    return {static_cast<int>(value), frame_category()};
}

}  // namespace sweepcast::frame

template <>
struct boost::system::is_error_code_enum<sweepcast::frame::errc> : std::true_type {};
