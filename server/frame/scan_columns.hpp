// A sweep as the columns of a Scan message (proto/sweepcast/v1/scan.proto), and back: no sample
// changes by a bit.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "driver/protocol/answer_type.hpp"
#include "driver/protocol/result.hpp"
#include "driver/protocol/sweep.hpp"

#include <chrono>
#include <cstddef>
#include <string>

namespace sweepcast::v1 {
class Scan;
}

namespace sweepcast::frame {

/// The most samples of a scan. The densest scanner takes about 3,200 a turn, and no sweep has more
/// than 8192.
constexpr std::size_t max_samples = 65536;

/// A scan as its reader gets it.
struct DecodedScan {
    protocol::Sweep sweep;
    std::string mode;
    protocol::AnswerType answer_type{protocol::AnswerType::normal};
    /// The usual time from one sample to the next.
    std::chrono::microseconds sample_period{};
    /// When the first sample was taken, since the UNIX epoch; 0 if not known.
    std::chrono::nanoseconds first_unix{};
};

/// Puts the sweep into `scan`, whatever it held before; its memory is used again.
/// Every sample comes back exactly. Of the rest: a period that no uint32 of microseconds holds
/// becomes the nearest that does, a wall-clock time outside 1970..2262 becomes 0, and a mode's name
/// keeps printable ASCII only. Throws std::length_error for more than max_samples, which no sweep
/// assembler gives out.
void to_columns(const device::CapturedSweep& captured, v1::Scan& scan);

/// Reads a scan, which is hostile: everything is checked before memory is taken for it.
/// Errors: errc::too_many_samples, column_length_wrong, unit_unknown, angle_out_of_range,
/// distance_out_of_range, quality_out_of_range, flag_out_of_range, answer_type_unknown.
Result<DecodedScan> from_columns(const v1::Scan& scan);

}  // namespace sweepcast::frame
