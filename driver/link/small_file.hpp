// One-line files, as sysfs and procfs have them.
#pragma once

#include <filesystem>
#include <string>

namespace sweepcast::link {

/// The first line of `path`, at most 255 bytes, of which only printable ASCII is kept: such texts
/// come from devices and processes and end up in logs. Empty if there is no such file.
std::string read_line(const std::filesystem::path& path);

/// `text` without anything but printable ASCII and without spaces at the ends.
std::string printable(std::string text);

}  // namespace sweepcast::link
