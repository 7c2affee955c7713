// Text from a device, made fit for a protobuf string.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace sweepcast::frame {

/// `text` with "?" for all but printable ASCII. A protobuf string must be UTF-8, or its reader
/// refuses the whole message, and what a device calls a scan mode need not be.
inline std::string printable(std::string_view text) {
    std::string result(text);
    std::replace_if(
        result.begin(),
        result.end(),
        [](char c) { return c < ' ' || c > '~'; },
        '?'
    );
    return result;
}

}  // namespace sweepcast::frame
