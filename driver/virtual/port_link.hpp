// PortLink: a symbolic link to the virtual lidar's port, so that its path stays the same from run
// to run.
#pragma once

#include "driver/protocol/result.hpp"

#include <string>

namespace sweepcast::virtual_lidar {

/// Owns the link: it is removed with this object, unless someone has put something else in its
/// place.
class PortLink {
public:
    /// Links `path` to `port`. A link that is there already is replaced in one step if it is of an
    /// instance that no longer runs: its target is gone, or was given to us. Nothing else is
    /// touched. Errors: errc::link_unavailable.
    static Result<PortLink, Problem> create(std::string path, std::string port);

    PortLink(PortLink&& other) noexcept;
    PortLink& operator=(PortLink&& other) noexcept;
    ~PortLink();

    [[nodiscard]] const std::string& path() const { return path_; }

private:
    PortLink(std::string path, std::string port);
    void remove() noexcept;

    std::string path_;  // empty: owns nothing
    std::string port_;
};

}  // namespace sweepcast::virtual_lidar
