#pragma once
/// Internal to engine/record: the seal at the end of every finished file, which is checked before HDF5 reads the file.
///
///     … the HDF5 file …   "CVTFSEAL"   length of the file before the seal   its Checksum   Checksum of these 24 bytes
///
/// HDF5 and h5py pass over what comes behind a file's end. A file that is still being written, or whose writer was killed, has no seal.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "engine/base/hash.hpp"
#include "engine/base/input_file.hpp"

namespace cvtflow::engine {

inline constexpr std::size_t seal_size = 32;

enum class Seal {
    whole,   ///< the file is what was sealed
    broken,  ///< the file has changed since
    none,
};

/// The seal of a file of that length and checksum.
[[nodiscard]] std::array<std::byte, seal_size> seal_of(std::uint64_t length, const Checksum& contents) noexcept;

/// Reads all of a file that ends with a seal. @throws InputError
[[nodiscard]] Seal inspect_seal(const InputFile& file);

/// Writes all bytes at a place of a file. @return 0 or an errno
[[nodiscard]] int write_at(int descriptor, std::uint64_t place, std::span<const std::byte> bytes) noexcept;

/// Reads a file from its beginning and writes its seal behind it. @param length of what is sealed @return 0 or an errno
[[nodiscard]] int write_seal(int descriptor, std::uint64_t length) noexcept;

}  // namespace cvtflow::engine
