#include "engine/base/hash.hpp"

#include <bit>

namespace cvtflow::engine {

void Hash::add_byte(std::uint8_t byte) noexcept { value_ = (value_ ^ byte) * 0x100000001b3ULL; }

Hash& Hash::add(std::span<const std::byte> bytes) noexcept {
    for (const std::byte byte : bytes) {
        add_byte(std::to_integer<std::uint8_t>(byte));
    }
    return *this;
}

Hash& Hash::add(std::span<const std::uint8_t> bytes) noexcept { return add(std::as_bytes(bytes)); }

Hash& Hash::add(std::span<const double> values) noexcept {
    for (const double value : values) {
        add(std::bit_cast<std::uint64_t>(value));
    }
    return *this;
}

Hash& Hash::add(std::string_view text) noexcept { return add(std::as_bytes(std::span(text.data(), text.size()))); }

Hash& Hash::add(std::uint64_t word) noexcept {
    for (int shift = 0; shift < 64; shift += 8) {
        add_byte(static_cast<std::uint8_t>(word >> shift));
    }
    return *this;
}

std::string Hash::hex() const { return engine::hex(value_); }

std::string hex(std::uint64_t word) {
    std::string text(16, '0');
    for (int digit = 0; digit < 16; ++digit) {
        text[static_cast<std::size_t>(digit)] = "0123456789abcdef"[(word >> (60 - 4 * digit)) & 15U];
    }
    return text;
}

std::uint64_t state_hash(std::span<const double> state) noexcept { return Hash{}.add(state).value(); }

}  // namespace cvtflow::engine
