#include "driver/device/phase.hpp"

namespace sweepcast::device {

std::string_view name(Phase phase) {
    switch (phase) {
    case Phase::disconnected:
        return "disconnected";
    case Phase::absent:
        return "absent";
    case Phase::opening:
        return "opening";
    case Phase::identifying:
        return "identifying";
    case Phase::idle:
        return "idle";
    case Phase::starting:
        return "starting";
    case Phase::scanning:
        return "scanning";
    case Phase::stalled:
        return "stalled";
    case Phase::stopping:
        return "stopping";
    case Phase::protection_stop:
        return "protection stop";
    case Phase::resetting:
        return "resetting";
    case Phase::backing_off:
        return "backing off";
    case Phase::failed:
        return "failed";
    }
    return "unknown";
}

}  // namespace sweepcast::device
