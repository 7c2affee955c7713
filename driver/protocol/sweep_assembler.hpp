// SweepAssembler: samples -> sweeps, one per revolution.
#pragma once

#include "driver/protocol/decoded.hpp"
#include "driver/protocol/sweep.hpp"

#include <vector>

namespace sweepcast::protocol {

/// Cuts the samples of a stream into revolutions.
class SweepAssembler {
public:
    /// Appends to `finished` every sweep that `decoded` completes.
    void push(const Decoded& decoded, std::vector<Sweep>& finished);

    /// Takes back a sweep that is no longer needed, to use its memory again.
    void recycle(Sweep&& spent);
};

}  // namespace sweepcast::protocol
