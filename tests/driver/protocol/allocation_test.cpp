// Decoding allocates nothing per packet: the only memory is the caller's, which is used again.
#include "tests/driver/protocol/decoding.hpp"
#include "tests/support/vector.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>
#include <string>

namespace {

std::size_t allocations = 0;

void* counted(std::size_t size) {
    ++allocations;
    if (void* memory = std::malloc(size > 0 ? size : 1)) {
        return memory;
    }
    throw std::bad_alloc{};
}

}  // namespace

// Every allocation of this program is counted: those that are for arrays or do not throw end here.
void* operator new(std::size_t size) {
    return counted(size);
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}

namespace sweepcast::protocol {
namespace {

class AllocationTest : public testing::TestWithParam<std::string> {
protected:
    AllocationTest() {
        // More than any piece can give.
        decoded_.samples.reserve(4096);
        decoded_.events.reserve(512);
    }

    /// Decodes the whole vector in pieces as a serial port gives them.
    void decode_all() {
        constexpr std::size_t chunk_bytes = 512;
        for (std::span<const std::uint8_t> rest{vector_.bytes}; !rest.empty();) {
            const auto chunk = rest.first(std::min(chunk_bytes, rest.size()));
            rest = rest.subspan(chunk.size());
            decoded_.clear();
            decoder_.push(chunk, {}, decoded_);
            samples_ += decoded_.samples.size();
        }
    }

    const test::Vector vector_ = test::load_vector(GetParam());
    Decoder decoder_ = make_decoder(vector_.type, vector_.settings);
    Decoded decoded_;
    std::size_t samples_{};
};

TEST_P(AllocationTest, NoneOnceTheCallersVectorsHaveGrown) {
    const auto before = allocations;
    decode_all();
    const auto after = allocations;
    EXPECT_EQ(after, before);
    ASSERT_GT(samples_, 0U);
}

TEST(AllocationCountTest, SeesAVectorGrow) {
    const auto before = allocations;
    const std::vector<int> vector(1000);
    EXPECT_EQ(allocations, before + 1) << vector.size();
}

INSTANTIATE_TEST_SUITE_P(
    Streams,
    AllocationTest,
    testing::Values(
        "81_room",
        "81_damage",
        "82_room",
        "82_damage",
        "83_room",
        "83_damage",
        "84_room",
        "84_damage",
        "85_room",
        "85_damage",
        "86_room",
        "86_damage"
    ),
    [](const auto& tested) { return "v" + tested.param; }
);

}  // namespace
}  // namespace sweepcast::protocol
