#include <gtest/gtest.h>
#include <array>
#include <random>
#include <vector>

#include "engine/base/hash.hpp"

namespace cvtflow::engine {

namespace {

// Vectors of the FNV reference (isthe.com/chongo/tech/comp/fnv).
TEST(Hash, IsFnv1aOf64Bits) {
    EXPECT_EQ(Hash{}.hex(), "cbf29ce484222325");
    EXPECT_EQ(Hash{}.add(std::string_view("a")).hex(), "af63dc4c8601ec8c");
    EXPECT_EQ(Hash{}.add(std::string_view("foo")).add(std::string_view("bar")).hex(), "85944171f73967e8");
    EXPECT_EQ(hex(0x1fULL), "000000000000001f");
}

TEST(Hash, ReadsDoublesAsLittleEndianBytes) {
    const std::array<std::uint8_t, 8> one{0, 0, 0, 0, 0, 0, 0xf0, 0x3f};  // 1.0 in IEEE 754
    EXPECT_EQ(state_hash(std::array{1.0}), Hash{}.add(std::span<const std::uint8_t>(one)).value());
}

TEST(Hash, DistinguishesNegativeZeroFromZeroAndSeesOrder) {
    EXPECT_NE(state_hash(std::array{0.0}), state_hash(std::array{-0.0}));
    EXPECT_NE(state_hash(std::array{1.0, 2.0}), state_hash(std::array{2.0, 1.0}));
}

std::vector<std::byte> some_bytes(std::size_t count) {
    std::mt19937 draw(3);
    std::vector<std::byte> bytes(count);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(draw() & 255U);
    return bytes;
}

TEST(Checksum, DoesNotDependOnHowBytesWereCutIntoCalls) {
    const std::vector<std::byte> bytes = some_bytes(300);
    const std::uint64_t whole = Checksum().add(bytes).value();
    for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
        const std::span<const std::byte> all(bytes);
        EXPECT_EQ(Checksum().add(all.first(cut)).add(all.subspan(cut)).value(), whole);
    }
}

}  // namespace

}  // namespace cvtflow::engine
