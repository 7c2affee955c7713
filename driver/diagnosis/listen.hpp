// Listens on a line: what is heard at each line speed, unasked and when a lidar is asked who it is.
#pragma once

#include "driver/diagnosis/answer_findings.hpp"
#include "driver/link/link.hpp"
#include "driver/protocol/result.hpp"

#include <boost/asio/awaitable.hpp>

#include <cstdint>
#include <span>

namespace sweepcast::diagnosis {

/// Ends a scan that may be running and asks who is there at each of these speeds in turn, until a
/// lidar answers, the same twice; adds what was heard to `line`, and leaves the line at the speed
/// of what tells most. On a network there is one try, without a speed. Takes at most 0.7 s a speed
/// where nothing comes, 4 s where a lidar boots.
/// Errors: those of the link.
boost::asio::awaitable<Result<void>>
listen(link::Link& link, std::span<const std::uint32_t> bauds, LineLook& line);

}  // namespace sweepcast::diagnosis
