#include "tests/support/time_errors.hpp"

#include "driver/device/scan_reader.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace sweepcast::test {
namespace {

using namespace std::chrono_literals;
using protocol::Sweep;

double quantile(const std::vector<double>& sorted, double part) {
    const auto last = static_cast<double>(sorted.size()) - 1.0;
    return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(part * last)];
}

}  // namespace

std::vector<Sweep> reckoned_back(const LineScan& scan, protocol::AnswerType type) {
    auto decoder = protocol::Decoder::create(type, {scan.sample_duration(), scan.baud(), false});
    protocol::SweepAssembler assembler;
    protocol::Decoded decoded;
    std::vector<Sweep> sweeps;
    for (const auto& read : scan.reads()) {
        decoded.clear();
        decoder->push(read.bytes, {read.at, 10'000'000'000ns / scan.baud()}, decoded);
        assembler.push(decoded, sweeps);
    }
    return sweeps;
}

std::vector<Sweep> as_read(const LineScan& scan, protocol::AnswerType type) {
    device::LineQuality line;
    const device::ScanMode mode{
        .name = "",
        .answer_type = type,
        .sample_duration = scan.sample_duration()};
    auto reader = device::ScanReader::create(type, mode, scan.baud(), line);
    std::vector<Sweep> sweeps;
    for (const auto& read : scan.reads()) {
        reader->push(read.bytes, read.at, sweeps);
    }
    return sweeps;
}

TimeErrors time_errors(const LineScan& scan, const std::vector<Sweep>& sweeps) {
    TimeErrors result;
    std::vector<double> errors_us;
    std::vector<double> stated_us;
    std::size_t within = 0;
    protocol::SampleTime last{};
    std::uint16_t angle = 0;
    for (const auto& sweep : sweeps) {
        double worst_us = 0.0;
        for (const auto& sample : sweep.samples) {
            result.back += sample.time <= last ? 1U : 0U;
            last = sample.time;
            const auto step = static_cast<std::int16_t>(sample.angle.raw - angle);
            angle = sample.angle.raw;
            if (std::abs(step) > 65536 / 64) {
                continue;
            }
            const auto time_us = static_cast<double>(sample.time.time_since_epoch().count());
            const auto error_us = std::abs(time_us - scan.true_time_us(sample));
            worst_us = std::max(worst_us, error_us);
            errors_us.push_back(error_us);
        }
        stated_us.push_back(static_cast<double>(sweep.time_uncertainty.count()));
        within += worst_us <= stated_us.back() ? 1U : 0U;
    }
    std::ranges::sort(errors_us);
    std::ranges::sort(stated_us);
    result.median_us = quantile(errors_us, 0.5);
    result.p99_us = quantile(errors_us, 0.99);
    result.greatest_us = quantile(errors_us, 1.0);
    result.stated_us = quantile(stated_us, 0.5);
    if (!sweeps.empty()) {
        result.within = static_cast<double>(within) / static_cast<double>(sweeps.size());
    }
    return result;
}

}  // namespace sweepcast::test
