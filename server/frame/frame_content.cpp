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
    content.gap = captured.gap;
    content.period = captured.sweep.period;
    content.losses = captured.sweep.losses;
    return content;
}

FrameContent sweep_under_way(std::string_view lidar, const device::SweepProgress& progress) {
    FrameContent content;
    content.lidar = lidar;
    content.sequence = progress.sequence;
    content.samples = progress.sweep.samples;
    content.mode = progress.mode;
    content.answer_type = progress.answer_type;
    content.sample_duration = progress.sample_duration;
    content.monotonic_to_unix = progress.monotonic_to_unix;
    content.time_uncertainty = progress.sweep.time_uncertainty;
    content.clock_step = progress.clock_step;
    content.gap = progress.gap;
    return content;
}

}  // namespace sweepcast::frame
