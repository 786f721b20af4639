#pragma once
/// Checksum of whole files: 64 bits, some 10 GB per second. Notices every change within eight bytes, and others but for chance; not
/// cryptographic.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace cvtflow::engine {

/// A running checksum over little-endian words in four interleaved chains, so that a processor works on four multiplications at once.
/// The sequence of bytes counts, not how it was cut into calls.
class Checksum {
public:
    Checksum& add(std::span<const std::byte> bytes) noexcept;
    /// Of all bytes so far and their number; more may follow.
    [[nodiscard]] std::uint64_t value() const noexcept;

private:
    void block(const std::byte* words) noexcept;

    std::array<std::uint64_t, 4> chains_{1, 2, 3, 4};
    std::array<std::byte, 32> rest_{};  ///< what does not fill a block yet, then zeros
    std::size_t held_ = 0;
    std::uint64_t size_ = 0;
};

}  // namespace cvtflow::engine
