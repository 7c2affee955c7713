#include "driver/virtual/error.hpp"

#include <string>

namespace sweepcast::virtual_lidar {

namespace {

class Category final : public boost::system::error_category {
public:
    const char* name() const noexcept override { return "sweepcast.virtual"; }

    std::string message(int code) const override {
        switch (static_cast<errc>(code)) {
        case errc::world_unreadable:
            return "the file of points cannot be read";
        case errc::world_malformed:
            return "the file is not a list of points";
        case errc::port_unavailable:
            return "no pseudo terminal is available";
        case errc::link_unavailable:
            return "the link to the port cannot be made";
        case errc::recording_unavailable:
            return "the recording cannot be written";
        case errc::capture_unusable:
            return "there is no captured scan to play";
        case errc::control_unavailable:
            return "the control socket cannot be had";
        case errc::not_now:
            return "the command cannot be obeyed now";
        case errc::invalid_option:
            return "an option has a value that makes no sense";
        }
        return "unknown error " + std::to_string(code);
    }
};

}  // namespace

const boost::system::error_category& virtual_lidar_category() {
    static const Category category;
    return category;
}

}  // namespace sweepcast::virtual_lidar
