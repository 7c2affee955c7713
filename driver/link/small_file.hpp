// One-line files, as sysfs and procfs have them.
#pragma once

#include <filesystem>
#include <string>

namespace sweepcast::link {

/// Returns the first line of `path`, at most 255 bytes of it, made printable (devices and processes
/// choose such texts) and without spaces at the ends. Empty if there is no such file.
std::string read_line(const std::filesystem::path& path);

}  // namespace sweepcast::link
