// What making a frame costs, and reading it: microseconds a sweep of every answer type, and what
// each level of zstd would give. One core; the fastest of several passes counts.
#include "server/frame/frame_decoder.hpp"
#include "server/frame/frame_encoder.hpp"
#include "server/frame/scan_columns.hpp"
#include "sweepcast/v1/scan.pb.h"
#include "sweepcast/v1/stream.pb.h"
#include "tests/support/virtual_sweeps.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace sweepcast::bench {
namespace {

using virtual_lidar::World;
using Microseconds = std::chrono::duration<double, std::micro>;

constexpr std::size_t sweeps = 30;
constexpr int passes = 7;
constexpr std::array levels{1, 2, 3, 4, 5, 6, 9, 12, 19};

/// The time of one call of `work` for each of `items`, in the fastest pass.
template <class Items, class Work>
double microseconds_each(const Items& items, Work work) {
    double best = std::numeric_limits<double>::max();
    for (int pass = 0; pass < passes; ++pass) {
        const auto begin = std::chrono::steady_clock::now();
        for (const auto& item : items) {
            work(item);
        }
        const Microseconds spent = std::chrono::steady_clock::now() - begin;
        best = std::min(best, spent.count() / static_cast<double>(items.size()));
    }
    return best;
}

v1::Frame frame_in(const frame::WireMessage& wire) {
    v1::ServerMessage message;
    const auto bytes = wire.message();
    if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
        throw std::runtime_error("not a message");
    }
    return message.frame();
}

void print_levels(const std::vector<std::string>& raw) {
    const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(
        ZSTD_createCCtx(),
        ZSTD_freeCCtx
    );
    std::string out(ZSTD_compressBound(1 << 20), '\0');
    for (const int level : levels) {
        std::size_t bytes = 0;
        const auto compress = [&](const std::string& scan) {
            bytes += ZSTD_compressCCtx(
                context.get(),
                out.data(),
                out.size(),
                scan.data(),
                scan.size(),
                level
            );
        };
        const auto spent = microseconds_each(raw, compress);
        fmt::print(
            "  {:>2}: {:5.0f} B {:6.1f}",
            level,
            static_cast<double>(bytes) / (passes * sweeps),
            spent
        );
    }
    fmt::print("\n");
}

void measure(const test::VirtualScanner& scanner) {
    const auto world = std::make_shared<const World>(World::living_room());
    const auto seen = test::virtual_sweeps(scanner, world, sweeps);
    frame::FrameEncoder encoder;
    frame::FrameDecoder decoder;
    v1::Scan scan;
    std::vector<std::string> raw;
    std::vector<v1::Frame> frames;
    double samples = 0;
    for (const auto& captured : seen.sweeps) {
        frame::to_columns(frame::whole_sweep(captured), {}, scan);
        raw.push_back(scan.SerializeAsString());
        frames.push_back(frame_in(*encoder.encode(frame::whole_sweep(captured), {})));
        samples += static_cast<double>(captured.sweep.samples.size());
    }
    const auto columns = microseconds_each(seen.sweeps, [&](const auto& captured) {
        frame::to_columns(frame::whole_sweep(captured), {}, scan);
    });
    const auto encode = microseconds_each(seen.sweeps, [&](const auto& captured) {
        (void)encoder.encode(frame::whole_sweep(captured), {});
    });
    const auto decode =
        microseconds_each(frames, [&](const auto& frame) { (void)decoder.decode(frame).value(); });
    fmt::print(
        "{:#x} {:<5} {:5.0f} samples: columns {:6.1f} us, all of encoding {:6.1f}, decoding "
        "{:6.1f}; zstd:",
        static_cast<unsigned>(scanner.type),
        scanner.model,
        samples / sweeps,
        columns,
        encode,
        decode
    );
    print_levels(raw);
}

}  // namespace
}  // namespace sweepcast::bench

int main() {
    for (const auto& scanner : sweepcast::test::one_of_each_type) {
        sweepcast::bench::measure(scanner);
    }
    return 0;
}
