// Reading one-line files.
#include "driver/link/small_file.hpp"

#include <array>
#include <fstream>
#include <utility>

namespace sweepcast::link {

std::string read_line(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::array<char, 256> line{};
    file.getline(line.data(), line.size());
    return printable(line.data());
}

std::string printable(std::string text) {
    std::erase_if(text, [](char c) { return c < ' ' || c > '~'; });
    const auto first = text.find_first_not_of(' ');
    if (first == std::string::npos) {
        return {};
    }
    return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

}  // namespace sweepcast::link
