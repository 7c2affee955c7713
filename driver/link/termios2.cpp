// Linux's termios2, which takes any baud rate: the usual tcsetattr() knows neither 256000 (A3, S1)
// nor what else is not in its table. In a file of its own because <asm/termbits.h> clashes with
// <termios.h>.
#include "driver/link/termios2.hpp"

#include <asm/termbits.h>
#include <cerrno>
#include <linux/serial.h>
#include <sys/ioctl.h>

namespace sweepcast::link {

namespace {

error_code last_system_error() {
    return {errno, boost::system::system_category()};
}

void make_raw_8n1(termios2& line, std::uint32_t baud) {
    line.c_iflag = IGNBRK;  // a break is noise of the power coming up, not a zero byte
    line.c_oflag = 0;
    line.c_lflag = 0;
    // No HUPCL: on the last close the kernel would release DTR, which starts the motor of an A1.
    constexpr tcflag_t cleared =
        CSIZE | CSTOPB | PARENB | PARODD | CMSPAR | CRTSCTS | HUPCL | CBAUD | CIBAUD;
    line.c_cflag = (line.c_cflag & ~cleared) | CS8 | CREAD | CLOCAL | BOTHER;
    line.c_ospeed = baud;
    line.c_ispeed = baud;
    // With VMIN 0 a non-blocking read of an idle line would give 0 bytes, as a hang-up does.
    line.c_cc[VMIN] = 1;
    line.c_cc[VTIME] = 0;
}

}  // namespace

Result<std::uint32_t> set_raw_8n1(int fd, std::uint32_t baud) {
    if (baud == 0) {
        return error_code(EINVAL, boost::system::system_category());
    }
    termios2 line{};
    if (::ioctl(fd, TCGETS2, &line) != 0) {
        return last_system_error();
    }
    make_raw_8n1(line, baud);
    if (::ioctl(fd, TCSETS2, &line) != 0 || ::ioctl(fd, TCGETS2, &line) != 0) {
        return last_system_error();
    }
    return line.c_ospeed;
}

Result<std::uint32_t> line_speed(int fd) {
    termios2 line{};
    if (::ioctl(fd, TCGETS2, &line) != 0) {
        return last_system_error();
    }
    return line.c_ospeed;
}

void ask_for_low_latency(int fd) {
    serial_struct settings{};
    if (::ioctl(fd, TIOCGSERIAL, &settings) == 0) {
        settings.flags |= static_cast<int>(ASYNC_LOW_LATENCY);
        (void)::ioctl(fd, TIOCSSERIAL, &settings);  // not allowed or not known: bursts it is
    }
}

}  // namespace sweepcast::link
