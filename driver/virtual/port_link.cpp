#include "driver/virtual/port_link.hpp"

#include "driver/virtual/error.hpp"

#include <filesystem>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace sweepcast::virtual_lidar {

namespace fs = std::filesystem;

namespace {

Problem unavailable(const std::string& path, const std::string& why, std::string hint) {
    return {errc::link_unavailable, path + ": " + why, std::move(hint)};
}

Problem cannot_link(const std::string& path, const std::error_code& failure) {
    return unavailable(
        path,
        "cannot make the link: " + failure.message(),
        "choose a path in a folder that exists and that you may write to"
    );
}

// Whether the link belongs to an instance that is gone. If our own port is its target, the system
// has given us the number that the dead instance had.
bool is_left_over(const fs::path& target, const std::string& port) {
    std::error_code ignored;
    return target == port || !fs::exists(target, ignored);
}

// A rename replaces the old link in one step: at no time is there none.
std::error_code replace(const std::string& path, const std::string& port) {
    const std::string temporary = path + "." + std::to_string(::getpid()) + ".new";
    std::error_code failure;
    fs::create_symlink(port, temporary, failure);
    if (failure) {
        return failure;
    }
    fs::rename(temporary, path, failure);
    if (failure) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
    }
    return failure;
}

}  // namespace

PortLink::PortLink(std::string path, std::string port)
    : path_(std::move(path))
    , port_(std::move(port)) {}

PortLink::PortLink(PortLink&& other) noexcept
    : path_(std::exchange(other.path_, {}))
    , port_(std::exchange(other.port_, {})) {}

PortLink& PortLink::operator=(PortLink&& other) noexcept {
    if (this != &other) {
        remove();
        path_ = std::exchange(other.path_, {});
        port_ = std::exchange(other.port_, {});
    }
    return *this;
}

PortLink::~PortLink() {
    remove();
}

void PortLink::remove() noexcept {
    if (path_.empty()) {
        return;
    }
    std::error_code failure;
    const auto target = fs::read_symlink(path_, failure);
    if (!failure && target.native() == port_) {
        fs::remove(path_, failure);
    }
}

Result<PortLink, Problem> PortLink::create(std::string path, std::string port) {
    std::error_code failure;
    fs::create_symlink(port, path, failure);
    if (!failure) {
        return PortLink(std::move(path), std::move(port));
    }
    if (failure != std::errc::file_exists) {
        return cannot_link(path, failure);
    }
    const auto target = fs::read_symlink(path, failure);
    if (failure) {
        return unavailable(path, "exists and is not a link", "choose another path for the link");
    }
    if (!is_left_over(target, port)) {
        return unavailable(
            path,
            "is a link to " + target.string() + ", which is in use",
            "stop the virtual lidar that made it; if it is gone already, remove the link, or "
            "choose "
            "another path for it"
        );
    }
    failure = replace(path, port);
    if (failure) {
        return cannot_link(path, failure);
    }
    return PortLink(std::move(path), std::move(port));
}

}  // namespace sweepcast::virtual_lidar
