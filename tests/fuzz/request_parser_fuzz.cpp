// Any bytes as what a host sends: each request that comes out is one that just went in, and is
// understood again when sent alone. The first byte chooses how long each byte takes.
#include "driver/protocol/request_parser.hpp"
#include "tests/fuzz/fuzzing.hpp"

#include <algorithm>
#include <optional>

namespace sweepcast::fuzz {
namespace {

using namespace protocol;

std::optional<Request> parse_alone(Input bytes) {
    RequestParser parser;
    std::optional<Request> last;
    for (const auto byte : bytes) {
        require(!last);
        last = parser.push(byte, {});
    }
    return last;
}

}  // namespace
}  // namespace sweepcast::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace sweepcast::fuzz;
    using namespace sweepcast::protocol;
    Input input{data, size};
    const std::chrono::milliseconds per_byte{16 * take_byte(input)};
    RequestParser parser;
    SampleTime now{};
    for (std::size_t taken = 1; taken <= input.size(); ++taken, now += per_byte) {
        const auto request = parser.push(input[taken - 1], now);
        if (!request) {
            continue;
        }
        const auto encoded = encode(*request);
        require(encoded.size() <= taken);
        const auto just_sent = input.subspan(taken - encoded.size(), encoded.size());
        require(std::equal(encoded.begin(), encoded.end(), just_sent.begin()));
        require(static_cast<std::int64_t>(encoded.size() - 1) * per_byte <= request_time_limit);
        require(parse_alone(encoded) == request);
    }
    return 0;
}
