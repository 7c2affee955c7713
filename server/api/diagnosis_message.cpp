#include "server/api/diagnosis_message.hpp"

namespace sweepcast::api {

namespace {

v1::Diagnosis::Verdict to_message(device::Verdict verdict) {
    switch (verdict) {
    case device::Verdict::ok:
        return v1::Diagnosis::OK;
    case device::Verdict::warning:
        return v1::Diagnosis::WARNING;
    case device::Verdict::failed:
        return v1::Diagnosis::FAILED;
    case device::Verdict::not_run:
        return v1::Diagnosis::NOT_RUN;
    }
    return v1::Diagnosis::UNKNOWN;
}

}  // namespace

void to_message(const device::Diagnosis& diagnosis, v1::Diagnosis& message) {
    message.set_port(diagnosis.port);
    message.set_verdict(to_message(diagnosis.verdict()));
    for (const auto& check : diagnosis.checks) {
        auto& added = *message.add_checks();
        added.set_id(check.id);
        added.set_title(check.title);
        added.set_verdict(to_message(check.verdict));
        added.set_finding(check.finding);
    }
    message.set_cause(diagnosis.cause);
    for (const auto& cause : diagnosis.likely_causes) {
        message.add_likely_causes(cause);
    }
    for (const auto& step : diagnosis.next_steps) {
        message.add_next_steps(step);
    }
}

}  // namespace sweepcast::api
