// What a sample costs on the wire, framing included: of every answer type, in real rooms and in the
// built-in one, beside what it costs on the serial line and as a foxglove.LaserScan of doubles with
// zstd. Usage: bytes_bench [FOLDER_OF_ROOMS]
#include "laser_scan.pb.h"
#include "server/frame/frame_encoder.hpp"
#include "tests/support/virtual_sweeps.hpp"

#include <fmt/format.h>
#include <zstd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace sweepcast::bench {
namespace {

using virtual_lidar::World;

constexpr std::size_t sweeps_per_room = 40;
/// A WebSocket puts four bytes in front of a message of 126 to 65,535 bytes.
constexpr std::size_t websocket_header = 4;

struct NamedWorld {
    std::string name;
    std::shared_ptr<const World> world;
};

std::vector<NamedWorld> worlds(const char* folder) {
    std::vector<NamedWorld> found{{"living room", std::make_shared<World>(World::living_room())}};
    if (folder == nullptr) {
        return found;
    }
    for (const auto* room : {"kitchen_a_dev1", "lab_a_dev1", "hall_a_dev1"}) {
        const auto path = std::filesystem::path(folder) / (std::string(room) + ".csv");
        auto world = World::load(path.string());
        if (!world) {
            fmt::print(stderr, "left out: {}\n", world.error().cause);
            continue;
        }
        found.push_back({room, std::make_shared<World>(std::move(*world))});
    }
    return found;
}

/// The sweep as other tools take it: metres counter-clockwise, with zstd's usual level.
std::size_t laser_scan_bytes(const device::CapturedSweep& captured) {
    ::bench::LaserScan scan;
    scan.mutable_timestamp()->set_seconds(1'700'000'000);
    scan.set_frame_id(captured.lidar);
    scan.mutable_pose()->mutable_orientation()->set_w(1);
    const auto count = static_cast<double>(captured.sweep.samples.size());
    scan.set_end_angle(-2 * std::numbers::pi * (count - 1) / count);
    for (const auto& sample : captured.sweep.samples) {
        scan.add_ranges(
            sample.distance.has_echo() ? sample.distance.millimetres() / 1000
                                       : std::numeric_limits<double>::infinity()
        );
        scan.add_intensities(sample.quality);
    }
    const auto raw = scan.SerializeAsString();
    std::string out(ZSTD_compressBound(raw.size()), '\0');
    return ZSTD_compress(out.data(), out.size(), raw.data(), raw.size(), 3);
}

struct Cost {
    double samples{};
    double line{};
    double plain{};       ///< TCP
    double dictionary{};  ///< TCP
    double websocket{};
    double laser_scan{};

    Cost& operator+=(const Cost& other) {
        samples += other.samples;
        line += other.line;
        plain += other.plain;
        dictionary += other.dictionary;
        websocket += other.websocket;
        laser_scan += other.laser_scan;
        return *this;
    }
};

Cost measure(const test::VirtualScanner& scanner, const std::shared_ptr<const World>& world) {
    const auto seen = test::virtual_sweeps(scanner, world, sweeps_per_room);
    frame::FrameEncoder encoder;
    Cost cost;
    for (const auto& captured : seen.sweeps) {
        const auto content = frame::whole_sweep(captured);
        const auto plain = encoder.encode(content, {});
        const auto dictionary = encoder.encode(content, {.dictionary = true});
        const auto samples = static_cast<double>(captured.sweep.samples.size());
        cost +=
            {samples,
             samples * seen.line_bytes_per_sample,
             static_cast<double>(plain->framed(frame::Framing::delimited).size()),
             static_cast<double>(dictionary->framed(frame::Framing::delimited).size()),
             static_cast<double>(plain->message().size() + websocket_header),
             static_cast<double>(laser_scan_bytes(captured))};
    }
    return cost;
}

void print_row(const std::string& name, const Cost& cost) {
    fmt::print(
        "{:<22} {:7.0f} {:7.3f} {:7.3f} {:7.3f} {:7.3f} {:9.3f} {:9.2f} {:9.2f} {:9.2f}\n",
        name,
        cost.samples / sweeps_per_room,
        cost.line / cost.samples,
        cost.plain / cost.samples,
        cost.websocket / cost.samples,
        cost.dictionary / cost.samples,
        cost.laser_scan / cost.samples,
        cost.plain / cost.line,
        cost.dictionary / cost.line,
        cost.plain / cost.laser_scan
    );
}

int run(const char* folder) {
    const auto rooms = worlds(folder);
    fmt::print(
        "bytes a sample, {} sweeps of a virtual lidar in each of {} rooms\n\n"
        "{:<22} {:>7} {:>7} {:>7} {:>7} {:>7} {:>9} {:>9} {:>9} {:>9}\n",
        sweeps_per_room,
        rooms.size(),
        "",
        "samples",
        "line",
        "TCP",
        "WS",
        "TCP+dic",
        "LaserScan",
        "TCP/line",
        "dic/line",
        "TCP/Laser"
    );
    double log_plain = 0;
    double log_dictionary = 0;
    for (const auto& scanner : test::one_of_each_type) {
        Cost all;
        for (const auto& [name, world] : rooms) {
            const auto cost = measure(scanner, world);
            print_row(fmt::format("  {}", name), cost);
            all += cost;
        }
        all.samples /= static_cast<double>(rooms.size());
        all.line /= static_cast<double>(rooms.size());
        all.plain /= static_cast<double>(rooms.size());
        all.dictionary /= static_cast<double>(rooms.size());
        all.websocket /= static_cast<double>(rooms.size());
        all.laser_scan /= static_cast<double>(rooms.size());
        print_row(fmt::format("{:#x} {}", static_cast<unsigned>(scanner.type), scanner.model), all);
        log_plain += std::log(all.plain / all.line);
        log_dictionary += std::log(all.dictionary / all.line);
    }
    fmt::print(
        "\nof the line, geometric mean over the answer types: {:.3f}, with dictionary {:.3f}\n",
        std::exp(log_plain / test::one_of_each_type.size()),
        std::exp(log_dictionary / test::one_of_each_type.size())
    );
    return 0;
}

}  // namespace
}  // namespace sweepcast::bench

int main(int argc, char** argv) {
    return sweepcast::bench::run(argc > 1 ? argv[1] : nullptr);
}
