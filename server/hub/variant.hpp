// Variant: one form in which frames are made, however many subscribers share it.
#pragma once

#include "driver/device/captured_sweep.hpp"
#include "server/frame/wire_message.hpp"
#include "server/frame/wish.hpp"
#include "server/frame/wish_encoder.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace sweepcast::hub {

/// Shared by all threads; what it is told apart by is its address.
class Variant {
public:
    explicit Variant(frame::Wish wish) : wish_(std::move(wish)) {}
    Variant(const Variant&) = delete;
    Variant& operator=(const Variant&) = delete;

    [[nodiscard]] const frame::Wish& wish() const { return wish_; }

    /// The frame of a sweep that had been published before anybody wanted it so. It is made once,
    /// whoever asks: who comes meanwhile waits, which takes a fraction of a millisecond.
    [[nodiscard]] frame::WireMessagePtr
    belated_frame(const device::CapturedSweep& sweep, frame::WishEncoder& encoder) const;

private:
    struct Belated {
        std::uint32_t lidar{};
        std::uint64_t sequence{};
        frame::WireMessagePtr message;
    };

    frame::Wish wish_;
    mutable std::mutex mutex_;
    mutable std::vector<Belated> belated_;  ///< the newest of each lidar
};

using VariantPtr = std::shared_ptr<const Variant>;

}  // namespace sweepcast::hub
