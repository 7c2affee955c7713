#include "driver/diagnosis/finding.hpp"

#include <algorithm>
#include <utility>

namespace sweepcast::diagnosis {

const StepNames& names(Step step) {
    return chain.at(static_cast<std::size_t>(step));
}

DiagnosisBuilder::DiagnosisBuilder(std::string port, OnCheck on_check)
    : on_check_(std::move(on_check)) {
    diagnosis_.port = std::move(port);
}

bool DiagnosisBuilder::add(Finding finding) {
    const auto& names_of_step = names(finding.step);
    const auto worst = diagnosis_.verdict();
    done_ = static_cast<std::size_t>(finding.step) + 1;
    diagnosis_.checks.push_back(
        {std::string(names_of_step.id),
         std::string(names_of_step.title),
         finding.verdict,
         std::move(finding.seen)}
    );
    // The first failure explains everything; before it, the first warning.
    const bool failed = finding.verdict == Verdict::failed;
    if (failed || (finding.verdict == Verdict::warning && worst == Verdict::ok)) {
        diagnosis_.cause = std::move(finding.cause);
        diagnosis_.likely_causes = std::move(finding.likely_causes);
        diagnosis_.next_steps = std::move(finding.next_steps);
    }
    if (on_check_) {
        on_check_(diagnosis_.checks.back());
    }
    return !failed;
}

Diagnosis DiagnosisBuilder::finish(std::span<const Step> without) {
    for (const auto& step : std::span(chain).subspan(done_)) {
        if (std::ranges::find(without, step.step) != without.end()) {
            continue;
        }
        diagnosis_.checks.push_back(
            {std::string(step.id), std::string(step.title), Verdict::not_run, ""}
        );
        if (on_check_) {
            on_check_(diagnosis_.checks.back());
        }
    }
    return std::move(diagnosis_);
}

}  // namespace sweepcast::diagnosis
