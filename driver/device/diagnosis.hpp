// Diagnosis: what is wrong with a lidar, found by walking the chain from its port to its first
// sweep. As a value, for people and programs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sweepcast::device {

enum class Verdict : std::uint8_t {
    ok,
    warning,  ///< it works, but not as it should
    failed,   ///< this is what is wrong; the checks after it were not run
    not_run,
};

/// One link of the chain.
struct Check {
    std::string id;     ///< stable, for programs: "port", "permission", "holder", "bytes", ...
    std::string title;  ///< for people: "The port exists"
    Verdict verdict{Verdict::not_run};
    std::string finding;  ///< what was seen, with values
};

struct Diagnosis {
    std::string port;  ///< as the user named it
    std::vector<Check> checks;
    /// Of the first check that failed (else of the first warning): what is wrong in one sentence,
    /// why most likely (likeliest first), and what to do. Empty if all is well.
    std::string cause;
    std::vector<std::string> likely_causes;
    std::vector<std::string> next_steps;

    /// The worst of the checks that were run.
    [[nodiscard]] Verdict verdict() const {
        auto worst = Verdict::ok;
        for (const auto& check : checks) {
            if (check.verdict == Verdict::failed) {
                return Verdict::failed;
            }
            if (check.verdict == Verdict::warning) {
                worst = Verdict::warning;
            }
        }
        return worst;
    }
};

}  // namespace sweepcast::device
