#include "server/cli/print.hpp"

namespace sweepcast::cli {

void write_text(std::FILE* out, std::string_view text) {
    (void)std::fwrite(text.data(), 1, text.size(), out);
    (void)std::fflush(out);
}

void print_json_line(std::FILE* out, std::string_view line) {
    print(out, "{}\n", line.substr(0, line.find('\n')));
}

std::string csv_field(std::string_view text) {
    auto shown = protocol::printable(text);
    if (shown.find_first_of(",\"") == std::string::npos) {
        return shown;
    }
    std::string quoted = "\"";
    for (const char c : shown) {
        quoted += c == '"' ? "\"\"" : std::string(1, c);
    }
    return quoted + "\"";
}

}  // namespace sweepcast::cli
