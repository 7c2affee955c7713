// What a Subscribe, or the query of a URL, asks for, checked.
#pragma once

#include "driver/protocol/result.hpp"
#include "server/frame/wish.hpp"
#include "server/stream/refusal.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace sweepcast::v1 {
class Subscribe;
}

namespace sweepcast::stream {

/// The wish in `subscribe`, which is hostile and is changed to what is understood of it: defaults
/// are filled in, dictionaries that are not ours left out. Its lidar is not looked at.
/// Refused, each with a code of its own: values out of range (infinite and NaN included), what does
/// not go together, too much of anything, and windows that leave nothing.
[[nodiscard]] Result<frame::Wish, Refusal> frame_wish(v1::Subscribe& subscribe);

/// The decoded parameters of a URL's query, in order.
using Query = std::vector<std::pair<std::string, std::string>>;

/// The Subscribe that a query such as "kind=sector&sector_deg=30&keep=350-10" writes out; each
/// parameter is called as the field. An unknown one is refused: a misspelt wish should not be taken
/// for none. So are those that cannot be read, and twice the same (but lists).
[[nodiscard]] Result<v1::Subscribe, Refusal> subscribe_from_query(const Query& query);

}  // namespace sweepcast::stream
