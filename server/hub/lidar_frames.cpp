#include "server/hub/lidar_frames.hpp"

#include "server/frame/frame_content.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::hub {

LidarFrames::Stream::Stream(VariantPtr wanted)
    : variant(std::move(wanted))
    , limit(variant->wish().least_interval)
    , cutter(variant->wish()) {}

std::vector<VariantFrame> LidarFrames::of(const device::CapturedSweep& sweep) {
    look_for_changes();
    std::vector<VariantFrame> frames;
    for (auto& stream : streams_) {
        auto made = stream.has_sectors()
                        ? sector_of(stream, frame::whole_sweep(sweep), stream.cutter.finish(sweep))
                        : sweep_of(stream, sweep);
        if (made.message) {
            frames.push_back(std::move(made));
        }
    }
    return frames;
}

std::vector<VariantFrame>
LidarFrames::of(std::string_view id, const device::SweepProgress& progress) {
    look_for_changes();
    std::vector<VariantFrame> frames;
    if (!has_sectors_) {
        return frames;
    }
    for (auto& stream : streams_) {
        const auto slice = stream.has_sectors() ? stream.cutter.cut(progress) : std::nullopt;
        if (!slice) {
            continue;
        }
        auto made = sector_of(stream, frame::sweep_under_way(id, progress), *slice);
        if (made.message) {
            frames.push_back(std::move(made));
        }
    }
    return frames;
}

/// Takes up what has become wanted, and drops what is not any more.
void LidarFrames::look_for_changes() {
    const auto version = variants_.version();
    if (version == version_) {
        return;
    }
    version_ = version;
    std::vector<Stream> streams;
    for (auto& variant : variants_.wanted(lidar_)) {
        const auto known = std::ranges::find(streams_, variant, &Stream::variant);
        streams.push_back(known != streams_.end() ? std::move(*known) : Stream(std::move(variant)));
    }
    streams_ = std::move(streams);
    has_sectors_ = std::ranges::any_of(streams_, &Stream::has_sectors);
}

VariantFrame LidarFrames::sweep_of(Stream& stream, const device::CapturedSweep& sweep) {
    auto content = frame::whole_sweep(sweep);
    const auto begin = content.samples.empty() ? protocol::SampleTime{} : content.samples[0].time;
    if (!stream.limit.lets_pass(begin, content.period)) {
        ++stream.omitted;
        return {stream.variant, stream.latest, false};
    }
    content.omitted = std::exchange(stream.omitted, 0);
    stream.latest = encoder_.encode(content, stream.variant->wish());
    return {stream.variant, stream.latest, true};
}

VariantFrame
LidarFrames::sector_of(Stream& stream, frame::FrameContent content, const frame::Slice& slice) {
    if (slice.begin == 0) {
        stream.next_sector = 0;
    }
    content.samples = content.samples.subspan(slice.begin, slice.end - slice.begin);
    content.sector = stream.next_sector;
    content.last = slice.last;
    if (stream.next_sector > 0) {
        content.clock_step = {};  // they were told in the first one
        content.gap = {};
    }
    auto message = encoder_.encode(content, stream.variant->wish(), slice.begin);
    stream.next_sector += message ? 1U : 0U;
    return {stream.variant, std::move(message), true};
}

}  // namespace sweepcast::hub
