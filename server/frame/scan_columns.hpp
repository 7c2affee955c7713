// Samples as the columns of a Scan message (proto/sweepcast/v1/scan.proto), and back: no sample
// changes by a bit, unless coarser units are wanted.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/frame/decoded_scan.hpp"
#include "server/frame/frame_content.hpp"

#include <cstddef>

namespace sweepcast::v1 {
class Scan;
}

namespace sweepcast::frame {

/// The most samples of a scan. The densest scanner takes about 3,200 per revolution, and no sweep
/// has more than protocol::max_sweep_samples, 16384.
constexpr std::size_t max_samples = 65536;

/// Puts the samples into `scan`, whatever it held before; its memory is used again.
/// Unless `format` wants less, every sample comes back exactly. Of the rest: the time of a sample
/// farther than farthest_us from the earliest becomes the farthest, a period that no uint32 of
/// microseconds holds the nearest that does, a wall-clock time outside 1970..2262 becomes 0, and a
/// mode's name is made printable. Throws std::length_error for more than max_samples,
/// which no sweep assembler gives out.
void to_columns(const FrameContent& content, const FrameFormat& format, v1::Scan& scan);

/// Reads a scan, which is hostile: everything is checked before memory is taken for it.
/// Errors: errc::too_many_samples, column_length_wrong, unit_unknown, angle_out_of_range,
/// distance_out_of_range, quality_out_of_range, flag_out_of_range, answer_type_unknown.
Result<DecodedScan> from_columns(const v1::Scan& scan);

}  // namespace sweepcast::frame
