#include "driver/device/error.hpp"

#include <string>

namespace sweepcast::device {

namespace {

class Category final : public boost::system::error_category {
public:
    [[nodiscard]] const char* name() const noexcept override { return "sweepcast.device"; }
    [[nodiscard]] std::string message(int value) const override {
        switch (static_cast<errc>(value)) {
        case errc::no_answer:
            return "the lidar does not answer";
        case errc::stream_silent:
            return "the lidar sends no samples";
        case errc::not_turning:
            return "the lidar sends samples, but no complete turn";
        case errc::protection_stop:
            return "the lidar is in protection stop";
        case errc::unknown_mode:
            return "no such scan mode";
        case errc::not_ready:
            return "the lidar cannot do that now";
        case errc::pending:
            return "the lidar has not done that yet";
        case errc::no_such_speed:
            return "the lidar is not made for that speed";
        case errc::fixed_speed:
            return "the speed of this lidar cannot be changed";
        case errc::baud_refused:
            return "the lidar would not be talked into another line speed";
        case errc::superseded:
            return "another command came first";
        case errc::another_lidar:
            return "another lidar is on the port";
        case errc::internal:
            return "a fault inside the gateway";
        case errc::shutting_down:
            return "the gateway is shutting down";
        }
        return "unknown error";
    }
};

}  // namespace

boost::system::error_code make_error_code(errc code) {
    static const Category category;
    return {static_cast<int>(code), category};
}

}  // namespace sweepcast::device
