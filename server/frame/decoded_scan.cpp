#include "server/frame/decoded_scan.hpp"

#include "server/frame/angle_units.hpp"

namespace sweepcast::frame {

double DecodedScan::degrees(const protocol::Sample& sample) const {
    const bool as_measured = angle_units_per_turn == 0 || angle_units_per_turn == q6_per_turn ||
                             angle_units_per_turn == q14_per_turn;
    if (as_measured) {
        return sample.angle.degrees();  // the vendor's value
    }
    return to_units(sample.angle, angle_units_per_turn) * 360.0 / angle_units_per_turn;
}

}  // namespace sweepcast::frame
