#include "engine/base/hash.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cstring>

namespace cvtflow::engine {

void Hash::add_byte(std::uint8_t byte) noexcept { value_ = (value_ ^ byte) * 0x100000001b3ULL; }

Hash& Hash::add(std::span<const std::byte> bytes) noexcept {
    for (const std::byte byte : bytes) add_byte(std::to_integer<std::uint8_t>(byte));
    return *this;
}

Hash& Hash::add(std::span<const std::uint8_t> bytes) noexcept { return add(std::as_bytes(bytes)); }

Hash& Hash::add(std::span<const double> values) noexcept {
    for (const double value : values) add(std::bit_cast<std::uint64_t>(value));
    return *this;
}

Hash& Hash::add(std::string_view text) noexcept { return add(std::as_bytes(std::span(text.data(), text.size()))); }

Hash& Hash::add(std::uint64_t word) noexcept {
    for (int shift = 0; shift < 64; shift += 8) add_byte(static_cast<std::uint8_t>(word >> shift));
    return *this;
}

std::string Hash::hex() const { return engine::hex(value_); }

std::string hex(std::uint64_t word) { return fmt::format("{:016x}", word); }

std::uint64_t state_hash(std::span<const double> state) noexcept { return Hash{}.add(state).value(); }

namespace {

constexpr std::uint64_t odd_factor = 0x9e3779b97f4a7c15ULL;  // 2^64 / golden ratio

/// Bijective in each argument for a fixed other one: a change of one word changes the result. The shift spreads high bits, which a product
/// alone leaves where they are.
std::uint64_t chained(std::uint64_t chain, std::uint64_t word) noexcept {
    const std::uint64_t mixed = chain ^ word;
    return std::rotl((mixed ^ (mixed >> 32U)) * odd_factor, 29);
}

}  // namespace

void Checksum::block(const std::byte* words) noexcept {
    for (std::size_t i = 0; i < chains_.size(); ++i) {
        std::uint64_t word = 0;
        std::memcpy(&word, words + 8 * i, sizeof word);
        chains_[i] = chained(chains_[i], word);
    }
}

Checksum& Checksum::add(std::span<const std::byte> bytes) noexcept {
    size_ += bytes.size();
    if (held_ > 0) {
        const std::size_t taken = std::min(bytes.size(), rest_.size() - held_);
        std::copy_n(bytes.begin(), taken, rest_.begin() + static_cast<std::ptrdiff_t>(held_));
        held_ += taken;
        bytes = bytes.subspan(taken);
        if (held_ < rest_.size()) return *this;
        block(rest_.data());
        held_ = 0;
    }
    for (; bytes.size() >= rest_.size(); bytes = bytes.subspan(rest_.size())) block(bytes.data());
    std::copy(bytes.begin(), bytes.end(), rest_.begin());
    held_ = bytes.size();
    return *this;
}

std::uint64_t Checksum::value() const noexcept {
    Checksum last = *this;
    std::fill(last.rest_.begin() + static_cast<std::ptrdiff_t>(held_), last.rest_.end(), std::byte{0});
    last.block(last.rest_.data());
    std::uint64_t sum = size_;
    for (const std::uint64_t chain : last.chains_) sum = chained(sum, chain);
    return sum ^ (sum >> 32U);
}

}  // namespace cvtflow::engine
