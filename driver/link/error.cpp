// Messages of link errors.
#include "driver/link/error.hpp"

#include <string>

namespace sweepcast::link {

namespace {

class LinkCategory final : public boost::system::error_category {
public:
    [[nodiscard]] const char* name() const noexcept override { return "sweepcast.link"; }

    [[nodiscard]] std::string message(int value) const override {
        switch (static_cast<errc>(value)) {
        case errc::timed_out:
            return "nothing came in time";
        case errc::interrupted:
            return "the operation was interrupted";
        case errc::disconnected:
            return "the device is gone: unplugged, powered off or no longer reachable";
        case errc::no_modem_lines:
            return "the line has no modem lines (DTR)";
        case errc::no_line_speed:
            return "the line has no baud rate";
        case errc::port_not_found:
            return "there is no such port";
        case errc::permission_denied:
            return "no permission to open the port";
        case errc::port_busy:
            return "the port is in use";
        case errc::not_a_serial_port:
            return "not a serial port";
        case errc::baud_not_supported:
            return "the adapter cannot run at this baud rate";
        case errc::io_error:
            return "the port could not be opened";
        case errc::host_not_found:
            return "there is no such host";
        case errc::connection_refused:
            return "nothing listens on this port of the host";
        case errc::unreachable:
            return "the host cannot be reached";
        }
        return "unknown link error " + std::to_string(value);
    }
};

}  // namespace

const boost::system::error_category& link_category() {
    static const LinkCategory category;
    return category;
}

}  // namespace sweepcast::link
