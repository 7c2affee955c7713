// Reading one-line files.
#include "driver/link/small_file.hpp"

#include "driver/protocol/printable.hpp"

#include <array>
#include <fstream>
#include <string_view>

namespace sweepcast::link {

std::string read_line(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::array<char, 256> line{};
    file.getline(line.data(), line.size());
    std::string_view text(line.data());
    const auto first = text.find_first_not_of(' ');
    if (first == std::string_view::npos) {
        return {};
    }
    text = text.substr(first, text.find_last_not_of(' ') - first + 1);
    return protocol::printable(text);
}

}  // namespace sweepcast::link
