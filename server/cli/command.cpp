#include "server/cli/command.hpp"

#include <fmt/core.h>

#include <cstdio>

namespace sweepcast::cli {

int report(const Problem& problem) {
    fmt::print(stderr, "sweepcast: {}\n", problem.cause);
    if (!problem.hint.empty()) {
        fmt::print(stderr, "  {}\n", problem.hint);
    }
    return 1;
}

}  // namespace sweepcast::cli
