#include "server/cli/command.hpp"

#include "server/cli/print.hpp"

#include <cstdio>

namespace sweepcast::cli {

namespace {

void tell(const Problem& problem) {
    print(stderr, "sweepcast: {}\n", problem.cause);
    if (!problem.hint.empty()) {
        print(stderr, "  {}\n", problem.hint);
    }
}

}  // namespace

int report(const Problem& problem) {
    tell(problem);
    return exit_failed;
}

int report_misuse(const Problem& problem) {
    tell(problem);
    return exit_misused;
}

}  // namespace sweepcast::cli
