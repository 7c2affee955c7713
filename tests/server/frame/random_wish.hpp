// Wishes for tests, and sweeps of recorded streams to try them on.
#pragma once

#include "driver/protocol/sweep.hpp"
#include "server/frame/wish.hpp"

#include <random>
#include <string>
#include <vector>

namespace sweepcast::frame {

/// A wish of the kind, each part of it set by chance.
Wish random_wish(Kind kind, std::mt19937_64& random);

/// Recorded streams with a whole turn in them, of every answer type.
const std::vector<std::string>& recorded_streams();

/// What was told of a stream that was read in pieces.
struct ReadStream {
    struct Event {
        /// A sweep complete, or (without `complete`) the samples of the one under way.
        protocol::Sweep sweep;
        bool complete{};
        protocol::SampleTime arrival{};
    };
    std::vector<Event> events;
};

/// A recorded stream, its samples handed over in pieces of random size.
ReadStream read_stream(const std::string& name, std::mt19937_64& random);

}  // namespace sweepcast::frame
