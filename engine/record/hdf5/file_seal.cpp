#include "engine/record/hdf5/file_seal.hpp"

#include <unistd.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <vector>

namespace cvtflow::engine {

namespace {

constexpr std::array<char, 8> seal_mark{'C', 'V', 'T', 'F', 'S', 'E', 'A', 'L'};
constexpr std::size_t bytes_at_once = std::size_t{1} << 16U;

void put_word(std::array<std::byte, seal_size>& seal, std::size_t place, std::uint64_t word) noexcept {
    std::memcpy(seal.data() + 8 * place, &word, sizeof word);
}

}  // namespace

std::array<std::byte, seal_size> seal_of(std::uint64_t length, const Checksum& contents) noexcept {
    std::array<std::byte, seal_size> seal{};
    std::memcpy(seal.data(), seal_mark.data(), seal_mark.size());
    put_word(seal, 1, length);
    put_word(seal, 2, contents.value());
    put_word(seal, 3, Checksum().add(std::span(seal).first(24)).value());
    return seal;
}

Seal inspect_seal(const InputFile& file) {
    std::array<std::byte, seal_size> found{};
    if (file.size() < seal_size || file.read(file.size() - seal_size, found.data(), seal_size) < seal_size) return Seal::none;
    std::uint64_t length = 0, own = 0;
    std::memcpy(&length, found.data() + 8, sizeof length);
    std::memcpy(&own, found.data() + 24, sizeof own);
    // Inconsistent bytes are no seal: they may be any end of a file.
    if (std::memcmp(found.data(), seal_mark.data(), seal_mark.size()) != 0 || own != Checksum().add(std::span(found).first(24)).value())
        return Seal::none;
    if (length != file.size() - seal_size) return Seal::broken;
    Checksum contents;
    std::vector<std::byte> block(bytes_at_once);
    for (std::uint64_t at = 0; at < length;) {
        const std::size_t some = file.read(at, block.data(), static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), length - at)));
        if (some == 0) return Seal::broken;
        contents.add(std::span(block).first(some));
        at += some;
    }
    return seal_of(length, contents) == found ? Seal::whole : Seal::broken;
}

int write_seal(int descriptor, std::uint64_t length) noexcept {
    Checksum contents;
    std::array<std::byte, 16384> block;
    for (std::uint64_t at = 0; at < length;) {
        const ssize_t some = pread(descriptor, block.data(), static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), length - at)),
                                   static_cast<off_t>(at));
        if (some < 0 && errno == EINTR) continue;
        if (some <= 0) return some < 0 ? errno : EIO;
        contents.add(std::span(block).first(static_cast<std::size_t>(some)));
        at += static_cast<std::uint64_t>(some);
    }
    const auto seal = seal_of(length, contents);
    for (std::size_t done = 0; done < seal.size();) {
        const ssize_t some = pwrite(descriptor, seal.data() + done, seal.size() - done, static_cast<off_t>(length + done));
        if (some < 0 && errno != EINTR) return errno;
        done += static_cast<std::size_t>(std::max<ssize_t>(some, 0));
    }
    return 0;
}

}  // namespace cvtflow::engine

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
    if (bytes.empty()) return state.c;
    std::array<std::uint32_t, 3> words{};
    for (;; state.mix()) {  // the last block, full or not, is finished instead of mixed
        words = {};
        const std::size_t some = std::min(bytes.size(), sizeof words);
        std::memcpy(words.data(), bytes.data(), some);
        state.a += words[0], state.b += words[1], state.c += words[2];
        bytes = bytes.subspan(some);
        if (bytes.empty()) break;
    }
    state.finish();
    return state.c;
}

void renew_superblock(std::span<std::byte> file) noexcept {
    const std::uint32_t sum = metadata_checksum(file.first(superblock_size));
    std::memcpy(file.data() + superblock_size, &sum, sizeof sum);
}

}  // namespace cvtflow::engine::hdf5
