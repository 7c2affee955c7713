// Refusal: the answer to a client that asked for something impossible.
#pragma once

#include <cstdint>
#include <string>

namespace sweepcast::stream {

struct Refusal {
    std::string code;  ///< stable, for programs
    std::string message;
    std::string hint;
    /// As the client numbered what is refused; 0: it did not.
    std::uint32_t request{};
};

}  // namespace sweepcast::stream
