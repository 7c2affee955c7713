// A diagnosis as a message.
#pragma once

#include "driver/device/diagnosis.hpp"
#include "sweepcast/v1/api.pb.h"

namespace sweepcast::api {

/// Fills `message`, which is empty, with the diagnosis.
void to_message(const device::Diagnosis& diagnosis, v1::Diagnosis& message);

}  // namespace sweepcast::api
