// Finding: the outcome of one check of a diagnosis, with what follows from it; and the chain of all
// checks.
#pragma once

#include "driver/device/diagnosis.hpp"

#include <array>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sweepcast::diagnosis {

using device::Check;
using device::Diagnosis;
using device::Verdict;

/// The links of the chain, in the order they are examined.
enum class Step : std::uint8_t {
    port,
    permission,
    holder,
    open,
    bytes,
    descriptor,
    info,
    health,
    modes,
    motor,
    sweep,
    quality,
    speed,
};

/// What does not depend on the case: what programs and what people call the step.
struct StepNames {
    Step step;
    std::string_view id;
    std::string_view title;
};

inline constexpr std::array<StepNames, 13> chain{{
    {Step::port, "port", "The port exists"},
    {Step::permission, "permission", "It may be opened"},
    {Step::holder, "holder", "Nobody else uses it"},
    {Step::open, "open", "It opens"},
    {Step::bytes, "bytes", "Something is heard on the line"},
    {Step::descriptor, "descriptor", "It answers as an RPLIDAR"},
    {Step::info, "info", "It says what it is"},
    {Step::health, "health", "It is healthy"},
    {Step::modes, "modes", "It says how it can scan"},
    {Step::motor, "motor", "The motor turns and samples come"},
    {Step::sweep, "sweep", "Whole revolutions come"},
    {Step::quality, "quality", "The line is clean"},
    {Step::speed, "speed", "It turns at its speed"},
}};

[[nodiscard]] const StepNames& names(Step step);

struct Finding {
    Step step{};
    Verdict verdict{Verdict::ok};
    std::string seen;  ///< with values
    /// Unless the verdict is ok: what is wrong in one sentence, why (likeliest first), what to do.
    std::string cause{};
    std::vector<std::string> likely_causes{};
    std::vector<std::string> next_steps{};
};

/// Called with every check as soon as it is done.
using OnCheck = std::function<void(const Check&)>;

/// Makes a diagnosis of findings, one after the other.
class DiagnosisBuilder {
public:
    /// `port` as the user named it; `on_check` may be empty.
    DiagnosisBuilder(std::string port, OnCheck on_check);

    /// Takes the finding of the next step; steps left out have no meaning for this link. Returns
    /// false if it failed: then only finish() is left to do.
    bool add(Finding finding);

    /// The diagnosis, with the steps after the last one added as not run, unless they are in
    /// `without`.
    [[nodiscard]] Diagnosis finish(std::span<const Step> without = {});

private:
    Diagnosis diagnosis_;
    OnCheck on_check_;
    std::size_t done_{};  ///< steps of the chain that have been passed
};

}  // namespace sweepcast::diagnosis
