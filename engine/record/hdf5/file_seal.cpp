#include "engine/record/hdf5/file_seal.hpp"

#include <unistd.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>

namespace cvtflow::engine {

namespace {

constexpr std::array<char, 8> seal_mark{'C', 'V', 'T', 'F', 'S', 'E', 'A', 'L'};

void put_word(std::array<std::byte, seal_size>& seal, std::size_t place, std::uint64_t word) noexcept {
    std::memcpy(seal.data() + 8 * place, &word, sizeof word);
}

/// Adds the first `length` bytes of a file to a checksum. @return 0, an errno, or -1 where the file ends before
int add_beginning(int descriptor, std::uint64_t length, Checksum& contents) noexcept {
    std::array<std::byte, 16384> block;
    for (std::uint64_t at = 0; at < length;) {
        const ssize_t some = pread(descriptor, block.data(), static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), length - at)),
                                   static_cast<off_t>(at));
        if (some < 0 && errno == EINTR) continue;
        if (some <= 0) return some < 0 ? errno : -1;
        contents.add(std::span(block).first(static_cast<std::size_t>(some)));
        at += static_cast<std::uint64_t>(some);
    }
    return 0;
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
    std::uint64_t length = 0, stored_sum = 0;
    std::memcpy(&length, found.data() + 8, sizeof length);
    std::memcpy(&stored_sum, found.data() + 24, sizeof stored_sum);
    // Inconsistent bytes are no seal: they may be any end of a file.
    if (std::memcmp(found.data(), seal_mark.data(), seal_mark.size()) != 0 ||
        stored_sum != Checksum().add(std::span(found).first(24)).value())
        return Seal::none;
    if (length != file.size() - seal_size) return Seal::broken;
    Checksum contents;
    const int reason = add_beginning(file.descriptor(), length, contents);
    if (reason > 0) throw InputError(std::strerror(reason));
    return reason == 0 && seal_of(length, contents) == found ? Seal::whole : Seal::broken;
}

int write_at(int descriptor, std::uint64_t place, std::span<const std::byte> bytes) noexcept {
    while (!bytes.empty()) {
        const ssize_t some = pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(place));
        if (some < 0 && errno != EINTR) return errno;
        const auto done = static_cast<std::size_t>(std::max<ssize_t>(some, 0));
        bytes = bytes.subspan(done);
        place += done;
    }
    return 0;
}

int write_seal(int descriptor, std::uint64_t length) noexcept {
    Checksum contents;
    if (const int reason = add_beginning(descriptor, length, contents); reason != 0) return reason > 0 ? reason : EIO;
    return write_at(descriptor, length, seal_of(length, contents));
}

}  // namespace cvtflow::engine

namespace cvtflow::engine::hdf5 {

namespace {

constexpr std::size_t superblock_size = 44;  ///< size in versions 2 and 3 with 8-byte addresses, without the checksum that follows

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
