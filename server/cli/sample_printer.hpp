// SamplePrinter: samples as CSV on standard output, and a sum of what was damaged.
#pragma once

#include "driver/protocol/decoded.hpp"
#include "driver/protocol/result.hpp"
#include "driver/protocol/sample.hpp"
#include "driver/protocol/sweep.hpp"

#include <cstdint>
#include <string>

namespace sweepcast::cli {

/// Prints samples and counts what comes out.
class SamplePrinter {
public:
    /// In degrees and millimetres if `units`, else in the units of the line.
    explicit SamplePrinter(bool units);

    /// Prints at once, after a header line if these are the first. Gives why standard output took
    /// no more, if it did not.
    error_code print(const protocol::Decoded& decoded);

    [[nodiscard]] std::uint64_t samples() const { return samples_; }

    /// Prints the sum to standard error.
    void summarize() const;

private:
    void add(const protocol::Sample& sample);

    bool units_;
    std::string text_;
    std::uint64_t samples_{};
    protocol::LineLosses losses_;
};

}  // namespace sweepcast::cli
