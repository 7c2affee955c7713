// What `doctor` prints: for people a line a check as soon as it is done, for programs JSON.
#pragma once

#include "driver/device/diagnosis.hpp"
#include "server/cli/print.hpp"

#include <cstdio>
#include <string>

namespace sweepcast::cli {

/// Text for people. Marks are words, so that they say the same without colour.
class DoctorText {
public:
    /// With `colour` the marks are coloured by ANSI sequences.
    DoctorText(std::FILE* out, bool colour) : out_(out), colour_(colour) {}

    /// Which port is examined from here on.
    void begin(const std::string& port);
    /// A check that is done, at once. One that failed explains those that were not run.
    void check(const device::Check& check);
    /// What follows from the checks: cause, likely causes, next steps.
    void conclude(const device::Diagnosis& diagnosis);

private:
    [[nodiscard]] Trusted painted(const std::string& text, const char* colour) const;

    std::FILE* out_;
    bool colour_;
};

/// Whether standard output is a terminal whose user does not mind colour (https://no-color.org).
[[nodiscard]] bool wants_colour();

}  // namespace sweepcast::cli
