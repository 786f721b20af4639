#include "engine/base/hash.hpp"

#include <gtest/gtest.h>

#include <array>

namespace cvtflow::engine {
namespace {

// Vectors of the FNV reference (isthe.com/chongo/tech/comp/fnv).
TEST(Hash, IsFnv1aOf64Bits) {
    EXPECT_EQ(Hash{}.hex(), "cbf29ce484222325");
    EXPECT_EQ(Hash{}.add(std::string_view("a")).hex(), "af63dc4c8601ec8c");
    EXPECT_EQ(Hash{}.add(std::string_view("foobar")).hex(), "85944171f73967e8");
}

TEST(Hash, DependsOnBytesAndNotOnHowTheyWereCut) {
    EXPECT_EQ(Hash{}.add(std::string_view("foo")).add(std::string_view("bar")).value(), Hash{}.add(std::string_view("foobar")).value());
}

TEST(Hash, ReadsDoublesAsLittleEndianBytes) {
    const std::array<std::uint8_t, 8> one{0, 0, 0, 0, 0, 0, 0xf0, 0x3f};  // 1.0 in IEEE 754
    EXPECT_EQ(state_hash(std::array{1.0}), Hash{}.add(std::span<const std::uint8_t>(one)).value());
}

TEST(Hash, TellsNegativeZeroFromZeroAndSeesOrder) {
    EXPECT_NE(state_hash(std::array{0.0}), state_hash(std::array{-0.0}));
    EXPECT_NE(state_hash(std::array{1.0, 2.0}), state_hash(std::array{2.0, 1.0}));
}

TEST(Hash, WritesSixteenHexadecimalDigits) {
    EXPECT_EQ(hex(0), "0000000000000000");
    EXPECT_EQ(hex(0x1fULL), "000000000000001f");
}

}  // namespace
}  // namespace cvtflow::engine
