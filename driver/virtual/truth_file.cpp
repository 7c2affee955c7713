#include "driver/virtual/truth_file.hpp"

#include "driver/virtual/error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <iterator>

namespace sweepcast::virtual_lidar {

Result<TruthFile, Problem> TruthFile::create(const std::string& path) {
    errno = 0;
    std::ofstream file(path, std::ios::trunc);
    file << "# what the scanner measured: stream, answer type, packet\n" << std::flush;
    if (!file) {
        return Problem{
            errc::recording_unavailable,
            path + ": cannot write what was measured: " + std::strerror(errno),
            "choose a file in a folder that exists and that you may write to",
        };
    }
    return TruthFile(std::move(file));
}

bool TruthFile::append(const Measured& measured) {
    std::string line;
    line.reserve(2 * measured.bytes.size() + 16);
    fmt::format_to(
        std::back_inserter(line),
        "{} {:02x} ",
        measured.stream.number,
        static_cast<unsigned>(measured.stream.answer)
    );
    for (const auto byte : measured.bytes) {
        fmt::format_to(std::back_inserter(line), "{:02x}", byte);
    }
    file_ << line << '\n';
    return file_.good();
}

}  // namespace sweepcast::virtual_lidar
