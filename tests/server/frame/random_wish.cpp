// Made-up wishes, recorded sweeps.
#include "tests/server/frame/random_wish.hpp"

#include "driver/protocol/decode.hpp"
#include "driver/protocol/sweep_assembler.hpp"
#include "tests/support/vector.hpp"

#include <algorithm>
#include <array>

namespace sweepcast::frame {

namespace {

using Random = std::mt19937_64;

bool by_chance(Random& random) {
    return random() % 2 == 0;
}

AngleSet random_angles(Random& random) {
    std::array<std::vector<AngleWindow>, 2> windows;
    for (auto& list : windows) {
        list.resize(random() % 3);
        for (auto& window : list) {
            window = {static_cast<double>(random() % 360), static_cast<double>(random() % 361)};
        }
    }
    const AngleSet angles(windows[0], windows[1]);
    return angles.is_empty() ? AngleSet() : angles;
}

FrameFormat random_format(Random& random) {
    FrameFormat format;
    format.compression = by_chance(random) ? Compression::zstd : Compression::none;
    if (by_chance(random)) {
        format.angle_units_per_turn = 360 + static_cast<std::uint32_t>(random() % 65177);
    }
    if (by_chance(random)) {
        format.distance_unit_um = 1 + static_cast<std::uint32_t>(random() % 1'000'000);
    }
    format.leave_out_quality = random() % 4 == 0;
    format.leave_out_flags = random() % 4 == 0;
    format.leave_out_times = random() % 4 == 0;
    return format;
}

}  // namespace

Wish random_wish(Kind kind, Random& random) {
    Wish wish;
    wish.kind = kind;
    wish.format = random_format(random);
    if (by_chance(random)) {
        wish.angles = random_angles(random);
    }
    if (by_chance(random)) {
        wish.nearest.raw = static_cast<std::uint32_t>(random() % 8000);
        wish.farthest.raw = wish.nearest.raw + static_cast<std::uint32_t>(random() % 40'000);
    }
    if (by_chance(random)) {
        wish.min_quality = static_cast<std::uint8_t>(random());
    }
    if (by_chance(random)) {
        wish.every_nth = 1 + static_cast<std::uint32_t>(random() % 7);
    }
    if (kind == Kind::sweep && by_chance(random)) {
        wish.bins.count =
            1 + static_cast<std::uint32_t>(random() % (by_chance(random) ? 720 : 16384));
        wish.bins.pick = by_chance(random) ? BinPick::nearest_angle : BinPick::minimum;
        wish.format.angle_units_per_turn = 2 * wish.bins.count;
    }
    if (kind == Kind::sector) {
        const bool by_time = by_chance(random);
        if (by_time) {
            wish.max_latency = std::chrono::microseconds(1 + random() % 50'000);
        }
        if (!by_time || by_chance(random)) {
            wish.sector_mdeg = 1 + static_cast<std::uint32_t>(random() % 360'000);
        }
    }
    return wish;
}

const std::vector<std::string>& recorded_streams() {
    static const std::vector<std::string> names{
        "81_room",
        "81_damage",
        "82_room",
        "82_damage",
        "82_border",
        "83_damage",
        "84_room",
        "84_damage",
        "84_border",
        "85_room",
        "85_border",
        "86_room"};
    return names;
}

ReadStream read_stream(const std::string& name, Random& random) {
    const auto vector = test::load_vector(name);
    // Bytes are handed over in pieces; times are made up, as the recorded ones are 0.
    auto decoder = protocol::Decoder::create(vector.type, vector.settings).value();
    protocol::SweepAssembler assembler;
    protocol::Decoded decoded;
    std::vector<protocol::Sweep> finished;
    ReadStream stream;
    protocol::SampleTime arrival(std::chrono::seconds(1000));
    const auto largest = 1 + random() % 600;
    for (std::size_t at = 0; at < vector.bytes.size();) {
        const auto size = std::min<std::size_t>(1 + random() % largest, vector.bytes.size() - at);
        arrival += std::chrono::microseconds(size * 87);
        decoded.clear();
        decoder.push(
            std::span(vector.bytes).subspan(at, size),
            {arrival, std::chrono::nanoseconds(87'000)},
            decoded
        );
        at += size;
        finished.clear();
        assembler.push(decoded, finished);
        for (auto& sweep : finished) {
            stream.events.push_back({std::move(sweep), true, arrival});
        }
        const auto unfinished = assembler.unfinished();
        if (!decoded.samples.empty() && !unfinished.samples.empty()) {
            stream.events.push_back(
                {{{unfinished.samples.begin(), unfinished.samples.end()}, {}, {}, unfinished.begun},
                 false,
                 arrival}
            );
        }
    }
    return stream;
}

}  // namespace sweepcast::frame
