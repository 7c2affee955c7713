// KnownLidars: bounds how many lidars, and how much of each, a gateway can make a client keep.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>

namespace sweepcast::v1 {
class Hello;
class Lidar;
}  // namespace sweepcast::v1

namespace sweepcast::client {

// The bounds of what a client keeps of a gateway, which may be hostile.
constexpr std::size_t most_lidars = 256;
constexpr std::size_t longest_lidar_name = 256;         ///< in bytes
constexpr std::size_t most_lidar_memory = 64UL * 1024;  ///< bytes in memory of one lidar's state
constexpr std::size_t longest_text = 1000;  ///< bytes of a refusal's or a farewell's words

/// Of one connection. Lidars go by their numbers, of which a gateway may invent ever more.
class KnownLidars {
public:
    /// Starts again with the lidars of a greeting. Removes from it those beyond the bounds, and
    /// returns how many these are.
    std::uint64_t begin(v1::Hello& hello);

    /// Returns whether a state is within the bounds. Its lidar is known or one of the first
    /// most_lidars. Its name has at most longest_lidar_name bytes. The state takes at most
    /// most_lidar_memory bytes.
    bool admit(const v1::Lidar& lidar);

private:
    std::set<std::uint32_t> numbers_;
};

}  // namespace sweepcast::client
