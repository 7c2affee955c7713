#include "server/frame/dictionary.hpp"

#include <zstd.h>

namespace sweepcast::frame {

std::uint32_t dictionary_id() {
    const auto bytes = dictionary_bytes();
    return ZSTD_getDictID_fromDict(bytes.data(), bytes.size());
}

}  // namespace sweepcast::frame
