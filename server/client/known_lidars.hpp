// KnownLidars: bounds how many lidars a gateway can make a client keep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>

namespace sweepcast::v1 {
class Hello;
class Lidar;
}  // namespace sweepcast::v1

namespace sweepcast::client {

/// What a client keeps of a gateway, which may be hostile: so many lidars, and so long names.
constexpr std::size_t most_lidars = 256;
constexpr std::size_t longest_lidar_name = 256;  ///< in bytes

/// Of one connection. Lidars go by their numbers, of which a gateway may invent ever more.
class KnownLidars {
public:
    /// Starts again with the lidars of a greeting. Removes from it those beyond the bound, and
    /// returns how many these are.
    std::uint64_t begin(v1::Hello& hello);

    /// Whether a state is of a lidar within the bound: one known, or one of the first most_lidars,
    /// with a name of at most longest_lidar_name bytes.
    bool admit(const v1::Lidar& lidar);

private:
    std::set<std::uint32_t> numbers_;
};

}  // namespace sweepcast::client
