// Which of the system's errors mean that the device is gone.
#include "driver/link/transport_link.hpp"

#include <cerrno>

namespace sweepcast::link {

error_code translate(const error_code& ec) {
    if (ec == boost::asio::error::eof) {
        return errc::disconnected;
    }
    if (ec.category() != boost::system::system_category()) {
        return ec;
    }
    switch (ec.value()) {
    case EIO:
    case ENXIO:
    case ENODEV:
    case EPIPE:
    case ECONNRESET:
    case ECONNABORTED:
    case EBADF:
    case ECONNREFUSED:  // UDP: the host says that nothing listens there (any more)
    case ETIMEDOUT:     // TCP: what was sent is not acknowledged
    case EHOSTUNREACH:
    case ENETUNREACH:
    case EHOSTDOWN:
    case ENETDOWN:
        return errc::disconnected;
    default:
        return ec;
    }
}

}  // namespace sweepcast::link
