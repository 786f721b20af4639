#pragma once
/// Internal to engine/record: the checksum that HDF5 puts behind each piece of its metadata.

#include <cstddef>
#include <cstdint>
#include <span>

namespace cvtflow::engine::hdf5 {

/// Bob Jenkins' lookup3 (hashlittle), beginning with 0.
[[nodiscard]] std::uint32_t metadata_checksum(std::span<const std::byte> bytes) noexcept;

/// Renews the checksum of a superblock of version 2 or 3, after its flags have been changed. @param file its first 48 bytes at least
void renew_superblock(std::span<std::byte> file) noexcept;

}  // namespace cvtflow::engine::hdf5
