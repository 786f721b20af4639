#pragma once
/// Hash of states and parameters: 64-bit FNV-1a over little-endian bytes, so equal on every machine. Not cryptographic.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace cvtflow::engine {

/// A running hash. Bits are hashed, not values: 0.0 and -0.0 differ, and so do NaNs with different payloads.
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

}  // namespace cvtflow::engine
