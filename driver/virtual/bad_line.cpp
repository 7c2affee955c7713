#include "driver/virtual/bad_line.hpp"

namespace sweepcast::virtual_lidar {

bool BadLine::is_good() const {
    return quality_.noise <= 0.0 && quality_.drop <= 0.0 && quality_.duplicate <= 0.0 &&
           to_lose_ == 0;
}

void BadLine::pass(std::uint8_t byte, std::vector<std::uint8_t>& arrived) {
    if (to_lose_ > 0) {
        --to_lose_;
        return;
    }
    if (random_.uniform() < quality_.drop) {
        return;
    }
    if (random_.uniform() < quality_.noise) {
        change(byte, arrived);
    } else {
        arrived.push_back(byte);
    }
    if (random_.uniform() < quality_.duplicate) {
        arrived.push_back(arrived.back());
    }
}

void BadLine::change(std::uint8_t byte, std::vector<std::uint8_t>& arrived) {
    arrived.push_back(static_cast<std::uint8_t>(byte ^ (1U + random_.next() % 255U)));
}

}  // namespace sweepcast::virtual_lidar
