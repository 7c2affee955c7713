// Makes the dictionary that short scans are compressed with: trained on sweeps and sectors of
// virtual lidars in the built-in room and in rooms of corners and pillars. The same bytes in every
// run. Usage: train_dictionary FILE
#include "server/frame/scan_columns.hpp"
#include "sweepcast/v1/scan.pb.h"
#include "tests/support/virtual_sweeps.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <memory>
#include <numbers>
#include <string>
#include <vector>
#include <zdict.h>

namespace sweepcast::dictionary {
namespace {

using protocol::AnswerType;
using virtual_lidar::World;

/// Larger ones bring less than a hundredth more.
constexpr std::size_t dictionary_size = 8 * 1024;
constexpr std::size_t sweeps_per_room = 24;
/// Sectors that programs ask for, in parts of a turn.
constexpr std::array<std::size_t, 3> sectors_per_turn{6, 12, 36};

/// Those whose scans are short. Long ones gain nothing.
constexpr std::array scanners{
    test::VirtualScanner{"a1m8", AnswerType::normal},
    test::VirtualScanner{"a1m8", AnswerType::express},
    test::VirtualScanner{"a2m8", AnswerType::ultra},
    test::VirtualScanner{"a3m1", AnswerType::ultra},
    test::VirtualScanner{"s1", AnswerType::dense},
    test::VirtualScanner{"s3", AnswerType::hq},
    test::VirtualScanner{"s2", AnswerType::dense},
    test::VirtualScanner{"c1", AnswerType::ultra_dense},
};

/// A rectangular room with round pillars, as a file of points has it.
std::shared_ptr<const World>
pillared_room(double half_width_mm, double half_depth_mm, int pillars) {
    std::string text = "angle_deg,distance_mm\n";
    constexpr int points = 720;
    for (int i = 0; i < points; ++i) {
        const double angle = 2 * std::numbers::pi * i / points;
        const double to_side = half_width_mm / std::max(std::abs(std::sin(angle)), 1e-9);
        const double to_end = half_depth_mm / std::max(std::abs(std::cos(angle)), 1e-9);
        double distance = std::min(to_side, to_end);
        for (int k = 0; k < pillars; ++k) {
            const double off = angle - 2 * std::numbers::pi * (k + 0.3) / pillars;
            constexpr double radius_mm = 150;
            const double away_mm = half_depth_mm * (0.5 + 0.08 * k);
            if (std::cos(off) > 0 && std::abs(std::sin(off)) * away_mm < radius_mm) {
                distance = std::min(distance, away_mm);
            }
        }
        text += std::to_string(i * 360.0 / points) + "," + std::to_string(distance) + "\n";
    }
    return std::make_shared<const World>(*virtual_lidar::PolarMap::parse(text, "pillars"));
}

struct Corpus {
    std::string bytes;
    std::vector<std::size_t> sizes;

    void add(const frame::FrameContent& content) {
        v1::Scan scan;
        frame::to_columns(content, {}, scan);
        const auto raw = scan.SerializeAsString();
        bytes += raw;
        sizes.push_back(raw.size());
    }
};

void add_sweep(const device::CapturedSweep& captured, Corpus& corpus) {
    const auto whole = frame::whole_sweep(captured);
    corpus.add(whole);
    const auto parts = sectors_per_turn[captured.sequence % sectors_per_turn.size()];
    const auto size = whole.samples.size() / parts;
    auto sector = whole;
    sector.kind = frame::Kind::sector;
    sector.period = {};
    sector.sector = static_cast<std::uint32_t>(captured.sequence % parts);
    sector.samples = whole.samples.subspan(sector.sector * size, size);
    corpus.add(sector);
}

std::string train() {
    const std::array rooms{
        std::make_shared<const World>(World::living_room()),
        pillared_room(2400, 1800, 3),
        pillared_room(6000, 9000, 7),
        pillared_room(900, 14000, 0)};
    Corpus corpus;
    std::uint64_t seed = 0;
    for (const auto& scanner : scanners) {
        for (const auto& room : rooms) {
            const auto seen = test::virtual_sweeps(scanner, room, sweeps_per_room, ++seed);
            for (const auto& captured : seen.sweeps) {
                add_sweep(captured, corpus);
            }
        }
    }
    std::string dictionary(dictionary_size, '\0');
    const auto size = ZDICT_trainFromBuffer(
        dictionary.data(),
        dictionary.size(),
        corpus.bytes.data(),
        corpus.sizes.data(),
        static_cast<unsigned>(corpus.sizes.size())
    );
    if (ZDICT_isError(size) != 0) {
        throw std::runtime_error(ZDICT_getErrorName(size));
    }
    dictionary.resize(size);
    return dictionary;
}

}  // namespace
}  // namespace sweepcast::dictionary

int main(int argc, char** argv) try {
    if (argc != 2) {
        std::cerr << "usage: train_dictionary FILE\n";
        return 2;
    }
    const auto dictionary = sweepcast::dictionary::train();
    std::ofstream file(argv[1], std::ios::binary);
    file << dictionary << std::flush;
    if (!file) {
        std::cerr << "cannot write " << argv[1] << "\n";
        return 1;
    }
    std::cout << argv[1] << ": " << dictionary.size() << " bytes, id "
              << ZDICT_getDictID(dictionary.data(), dictionary.size()) << "\n";
    return 0;
} catch (const std::exception& failure) {
    std::cerr << failure.what() << "\n";
    return 1;
}
