#include "engine/record/hdf5/file_seal.hpp"

#include <unistd.h>
#include <algorithm>
#include <array>
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
