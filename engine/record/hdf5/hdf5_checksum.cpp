#include "engine/record/hdf5/hdf5_checksum.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace cvtflow::engine::hdf5 {
namespace {

constexpr std::size_t superblock_size = 44;  ///< of versions 2 and 3 with 8-byte addresses, without the checksum that follows

struct Lookup3 {
    std::uint32_t a, b, c;

    void mix() noexcept {
        a -= c, a ^= std::rotl(c, 4), c += b;
        b -= a, b ^= std::rotl(a, 6), a += c;
        c -= b, c ^= std::rotl(b, 8), b += a;
        a -= c, a ^= std::rotl(c, 16), c += b;
        b -= a, b ^= std::rotl(a, 19), a += c;
        c -= b, c ^= std::rotl(b, 4), b += a;
    }
    void finish() noexcept {
        c ^= b, c -= std::rotl(b, 14);
        a ^= c, a -= std::rotl(c, 11);
        b ^= a, b -= std::rotl(a, 25);
        c ^= b, c -= std::rotl(b, 16);
        a ^= c, a -= std::rotl(c, 4);
        b ^= a, b -= std::rotl(a, 14);
        c ^= b, c -= std::rotl(b, 24);
    }
};

}  // namespace

std::uint32_t metadata_checksum(std::span<const std::byte> bytes) noexcept {
    const std::uint32_t begin = 0xdeadbeefU + static_cast<std::uint32_t>(bytes.size());
    Lookup3 state{begin, begin, begin};
    if (bytes.empty()) {
        return state.c;
    }
    std::array<std::uint32_t, 3> words{};
    for (;; state.mix()) {  // the last block, full or not, is finished instead of mixed
        words = {};
        const std::size_t some = std::min(bytes.size(), sizeof words);
        std::memcpy(words.data(), bytes.data(), some);
        state.a += words[0], state.b += words[1], state.c += words[2];
        bytes = bytes.subspan(some);
        if (bytes.empty()) {
            break;
        }
    }
    state.finish();
    return state.c;
}

void renew_superblock(std::span<std::byte> file) noexcept {
    const std::uint32_t sum = metadata_checksum(file.first(superblock_size));
    std::memcpy(file.data() + superblock_size, &sum, sizeof sum);
}

}  // namespace cvtflow::engine::hdf5
