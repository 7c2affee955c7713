#include "driver/device/device_state.hpp"

namespace sweepcast::device {

std::string_view name(Phase phase) {
    switch (phase) {
    case Phase::disconnected:
        return "disconnected";
    case Phase::identifying:
        return "identifying";
    case Phase::idle:
        return "idle";
    case Phase::starting:
        return "starting";
    case Phase::scanning:
        return "scanning";
    case Phase::stopping:
        return "stopping";
    case Phase::protection_stop:
        return "protection stop";
    case Phase::failed:
        return "failed";
    }
    return "unknown";
}

}  // namespace sweepcast::device
