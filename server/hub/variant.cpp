#include "server/hub/variant.hpp"

#include "server/frame/frame_content.hpp"

#include <algorithm>

namespace sweepcast::hub {

frame::WireMessagePtr
Variant::belated_frame(const device::CapturedSweep& sweep, frame::WishEncoder& encoder) const {
    const std::lock_guard lock(mutex_);
    auto known = std::ranges::find(belated_, sweep.lidar_number, &Belated::lidar);
    if (known != belated_.end() && known->sequence == sweep.sequence) {
        return known->message;
    }
    auto message = encoder.encode(frame::whole_sweep(sweep), wish_);
    if (known == belated_.end()) {
        belated_.push_back({sweep.lidar_number, sweep.sequence, message});
    } else if (known->sequence < sweep.sequence) {
        *known = {sweep.lidar_number, sweep.sequence, message};
    }
    return message;
}

}  // namespace sweepcast::hub
