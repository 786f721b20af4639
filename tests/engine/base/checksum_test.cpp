#include "engine/base/checksum.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <vector>

namespace cvtflow::engine {
namespace {

std::vector<std::byte> some_bytes(std::size_t count) {
    std::mt19937 draw(3);
    std::vector<std::byte> bytes(count);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(draw() & 255U);
    return bytes;
}

TEST(Checksum, ChangesWithEveryBitAndWithTheLength) {
    for (const std::size_t size : {1U, 8U, 31U, 32U, 33U, 200U}) {
        std::vector<std::byte> bytes = some_bytes(size);
        std::set<std::uint64_t> sums{Checksum().add(bytes).value()};
        for (std::size_t bit = 0; bit < 8 * size; ++bit) {
            bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
            EXPECT_TRUE(sums.insert(Checksum().add(bytes).value()).second) << size << " bytes, bit " << bit;
            bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
        }
        bytes.emplace_back();  // zeros also count
        EXPECT_TRUE(sums.insert(Checksum().add(bytes).value()).second);
    }
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
