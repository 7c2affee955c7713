#include "server/frame/frame_content.hpp"

namespace sweepcast::frame {

FrameContent whole_sweep(const device::CapturedSweep& captured) {
    FrameContent content;
    content.lidar = captured.lidar;
    content.sequence = captured.sequence;
    content.samples = captured.sweep.samples;
    content.mode = captured.mode;
    content.answer_type = captured.answer_type;
    content.sample_duration = captured.sample_duration;
    content.monotonic_to_unix = captured.monotonic_to_unix;
    content.time_uncertainty = captured.sweep.time_uncertainty;
    content.clock_step = captured.clock_step;
    content.period = captured.sweep.period;
    content.losses = captured.sweep.losses;
    return content;
}

}  // namespace sweepcast::frame
