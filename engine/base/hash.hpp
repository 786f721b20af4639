#pragma once
/// Hashes of bytes, equal on every machine and not cryptographic: Hash (64-bit FNV-1a) of states and parameters, and Checksum, faster, of
/// whole files.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace cvtflow::engine {

/// A running hash over little-endian bytes. Bits are hashed, not values: 0.0 and -0.0 differ, and so do NaNs with different payloads.
/// The sequence of bytes counts, not how it was cut into calls. About 1 ns per byte.
class Hash {
public:
    Hash& add(std::span<const std::byte> bytes) noexcept;
    Hash& add(std::span<const std::uint8_t> bytes) noexcept;
    Hash& add(std::span<const double> values) noexcept;  ///< values [any number]
    Hash& add(std::string_view text) noexcept;
    Hash& add(std::uint64_t word) noexcept;

    [[nodiscard]] std::uint64_t value() const noexcept { return value_; }
    /// 16 lower-case hexadecimal digits.
    [[nodiscard]] std::string hex() const;

private:
    void add_byte(std::uint8_t byte) noexcept;

    std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// 16 lower-case hexadecimal digits.
[[nodiscard]] std::string hex(std::uint64_t word);

/// Hash of a state, as tests, benchmarks and files print it. state [unknowns]
[[nodiscard]] std::uint64_t state_hash(std::span<const double> state) noexcept;

/// A running checksum of 64 bits over little-endian words in four interleaved chains, so that a processor works on four multiplications at
/// once: some 10 GB per second. The sequence of bytes counts, not how it was cut into calls. Notices every change within eight bytes, and
/// others but for chance.
class Checksum {
public:
    Checksum& add(std::span<const std::byte> bytes) noexcept;
    /// Hash of all bytes so far and their number; more may follow.
    [[nodiscard]] std::uint64_t value() const noexcept;

private:
    void block(const std::byte* words) noexcept;

    std::array<std::uint64_t, 4> chains_{1, 2, 3, 4};
    std::array<std::byte, 32> rest_{};  ///< bytes that do not fill a block yet, then zeros
    std::size_t held_ = 0;
    std::uint64_t size_ = 0;
};

}  // namespace cvtflow::engine
