// Next steps that several findings share.
#pragma once

#include <string_view>

namespace sweepcast::diagnosis {

inline constexpr std::string_view supply_advice =
    "give it a supply of its own: 5 V with 1.5 A (a phone charger, a powered hub) and a short, "
    "thick cable; not the USB port of a small board";
inline constexpr std::string_view cable_advice =
    "try another USB cable, short, directly into the computer, and press all plugs in firmly";

}  // namespace sweepcast::diagnosis
