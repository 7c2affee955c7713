#include "server/cli/sample_printer.hpp"

#include "server/cli/print.hpp"

#include <boost/system/errc.hpp>
#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <iterator>

namespace sweepcast::cli {

SamplePrinter::SamplePrinter(bool units)
    : units_(units)
    , text_(
          units ? "angle_deg,distance_mm,quality,flag\n" : "angle_z_q14,dist_mm_q2,quality,flag\n"
      ) {}

error_code SamplePrinter::print(const protocol::Decoded& decoded) {
    for (const auto& sample : decoded.samples) {
        add(sample);
    }
    samples_ += decoded.samples.size();
    for (const auto& event : decoded.events) {
        losses_.count(event);
    }
    const bool written = std::fwrite(text_.data(), 1, text_.size(), stdout) == text_.size();
    text_.clear();
    if (!written || std::fflush(stdout) != 0) {
        return {errno, boost::system::generic_category()};
    }
    return {};
}

void SamplePrinter::summarize() const {
    cli::print(
        stderr,
        "sweepcast: {} samples; {} checksum errors, {} bytes skipped, {} packets lost\n",
        samples_,
        losses_.checksum_errors,
        losses_.skipped_bytes,
        losses_.lost_packets
    );
}

void SamplePrinter::add(const protocol::Sample& sample) {
    const auto out = std::back_inserter(text_);
    const int quality = sample.quality;
    const int flag = sample.flag;
    if (units_) {
        // Enough digits to give back the lidar's own units.
        const auto degrees = sample.angle.degrees();
        const auto mm = sample.distance.millimetres();
        fmt::format_to(out, "{:.4f},{:.2f},{},{}\n", degrees, mm, quality, flag);
    } else {
        const auto angle = sample.angle.raw;
        fmt::format_to(out, "{},{},{},{}\n", angle, sample.distance.raw, quality, flag);
    }
}

}  // namespace sweepcast::cli
