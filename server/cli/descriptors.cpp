#include "server/cli/descriptors.hpp"

#include <sys/resource.h>

namespace sweepcast::cli {

std::size_t raise_descriptor_limit() {
    constexpr std::size_t customary = 1024;  // should the system not say
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) {
        return customary;
    }
    const auto before = limit.rlim_cur;
    limit.rlim_cur = limit.rlim_max;
    return setrlimit(RLIMIT_NOFILE, &limit) == 0 ? limit.rlim_cur : before;
}

}  // namespace sweepcast::cli
