#include "server/cli/doctor_output.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>
#include <unistd.h>
#include <vector>

namespace sweepcast::cli {

namespace {

using device::Verdict;

constexpr const char* red = "31;1";
constexpr const char* green = "32";
constexpr const char* yellow = "33;1";
constexpr const char* bold = "1";
constexpr const char* faint = "2";

struct Mark {
    std::string text;  ///< all of one width
    const char* colour;
};

Mark mark_of(Verdict verdict) {
    switch (verdict) {
    case Verdict::ok:
        return {"ok  ", green};
    case Verdict::warning:
        return {"warn", yellow};
    case Verdict::failed:
        return {"FAIL", red};
    case Verdict::not_run:
        break;
    }
    return {"-   ", faint};
}

void print_list(std::FILE* out, const std::vector<std::string>& lines) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
        print(out, "  {}. {}\n", i + 1, lines[i]);
    }
}

}  // namespace

Trusted DoctorText::painted(const std::string& text, const char* colour) const {
    const auto shown = protocol::printable(text);
    return {colour_ ? fmt::format("\x1b[{}m{}\x1b[0m", colour, shown) : shown};
}

void DoctorText::begin(const std::string& port) {
    print(out_, "{}\n", painted("Examining " + port, bold));
}

void DoctorText::check(const device::Check& check) {
    const auto mark = mark_of(check.verdict);
    const auto text = check.finding.empty() ? check.title : check.title + ": " + check.finding;
    print(out_, "  {}  {}\n", painted(mark.text, mark.colour), text);
}

void DoctorText::conclude(const device::Diagnosis& diagnosis) {
    if (diagnosis.cause.empty()) {
        print(out_, "\n{}\n", painted("All is well.", bold));
        return;
    }
    const bool failed = diagnosis.verdict() == Verdict::failed;
    const auto* heading = failed ? "What is wrong:" : "It works, but:";
    print(out_, "\n{} {}\n", painted(heading, bold), diagnosis.cause);
    if (!diagnosis.likely_causes.empty()) {
        print(out_, "\n{}\n", painted("Why, most likely:", bold));
        print_list(out_, diagnosis.likely_causes);
    }
    if (!diagnosis.next_steps.empty()) {
        print(out_, "\n{}\n", painted("What to do:", bold));
        print_list(out_, diagnosis.next_steps);
    }
}

bool wants_colour() {
    // Read before any thread is started.
    const char* no_colour = std::getenv("NO_COLOR");  // NOLINT(concurrency-mt-unsafe): alone
    const char* terminal = std::getenv("TERM");       // NOLINT(concurrency-mt-unsafe): alone
    const bool refused = no_colour != nullptr && *no_colour != '\0';
    const bool dumb = terminal == nullptr || std::string_view(terminal) == "dumb";
    return !refused && !dumb && isatty(STDOUT_FILENO) != 0;
}

}  // namespace sweepcast::cli
