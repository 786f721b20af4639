#pragma once
/// Numbers with a significand of 64 bits, in which the set-up computes: x86-64 has them as long double. Other processors emulate them,
/// since their long double has another significand and gives other bits. No function here is a kernel's.

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

namespace cvtflow::model {

/// ±significand 2^exponent, rounded to the nearest, ties to even, as x86-64 rounds a long double. The exponent has no limits.
/// Results that would be infinite are NaN.
class EmulatedExtended {
public:
    constexpr EmulatedExtended() = default;
    constexpr EmulatedExtended(double x) noexcept {
        const auto bits = __builtin_bit_cast(std::uint64_t, x);
        const int field = static_cast<int>(bits >> 52 & 0x7ff);
        const std::uint64_t fraction = bits & 0xfffffffffffffu;
        *this = rounded(bits >> 63 != 0, field == 0 ? fraction : fraction | 1ull << 52, field == 0 ? -1074 : field - 1075);
        if (field == 0x7ff) exponent_ = not_a_number;
    }
    /// significand 2^exponent
    static constexpr EmulatedExtended of(std::uint64_t significand, int exponent) noexcept { return rounded(false, significand, exponent); }

    /// Value rounded to a double, denormal numbers too.
    explicit operator double() const noexcept {
        if (exponent_ >= not_a_number) return std::numeric_limits<double>::quiet_NaN();
        const int dropped = exponent_ < -1085 ? -1074 - exponent_ : 11;
        const double size = std::ldexp(static_cast<double>(without(dropped)), exponent_ + dropped);
        return negative_ ? -size : size;
    }
    explicit operator std::int64_t() const noexcept { return static_cast<std::int64_t>(static_cast<double>(*this)); }

    friend constexpr EmulatedExtended operator-(EmulatedExtended a) noexcept {
        a.negative_ = !a.negative_;
        return a;
    }
    friend constexpr EmulatedExtended operator+(EmulatedExtended a, EmulatedExtended b) noexcept {
        if (b.significand_ == 0 || a.exponent_ >= not_a_number) return a.significand_ == 0 && a.negative_ != b.negative_ ? 0.0 : a;
        if (a.significand_ == 0 || b.exponent_ >= not_a_number) return b;
        if (a.exponent_ < b.exponent_) std::swap(a, b);
        const int behind = a.exponent_ - b.exponent_;
        const Wide large = Wide(a.significand_) << 63, shifted = Wide(b.significand_) << 63, small = behind < 128 ? shifted >> behind : 0;
        const bool cut = behind >= 128 || small << behind != shifted;
        if (a.negative_ == b.negative_) return rounded(a.negative_, large + small, a.exponent_ - 63, cut);
        if (large < small) return rounded(b.negative_, small - large, a.exponent_ - 63);  // of equal exponents
        return rounded(a.negative_ && large != small, large - small - (cut ? 1 : 0), a.exponent_ - 63, cut);
    }
    friend constexpr EmulatedExtended operator-(EmulatedExtended a, EmulatedExtended b) noexcept { return a + -b; }
    friend constexpr EmulatedExtended operator*(EmulatedExtended a, EmulatedExtended b) noexcept {
        const bool invalid = a.exponent_ >= not_a_number || b.exponent_ >= not_a_number;
        return rounded(a.negative_ != b.negative_, Wide(a.significand_) * b.significand_,
                       invalid ? not_a_number : a.exponent_ + b.exponent_);
    }
    friend constexpr EmulatedExtended operator/(EmulatedExtended a, EmulatedExtended b) noexcept {
        if (b.significand_ == 0 || a.exponent_ >= not_a_number || b.exponent_ >= not_a_number) return nan();
        const Wide numerator = Wide(a.significand_) << 64, rest = numerator % b.significand_ << 32;
        const Wide quotient = (numerator / b.significand_ << 32) + rest / b.significand_;
        return rounded(a.negative_ != b.negative_, quotient, a.exponent_ - b.exponent_ - 96, rest % b.significand_ != 0);
    }
    friend constexpr EmulatedExtended& operator+=(EmulatedExtended& a, EmulatedExtended b) noexcept { return a = a + b; }
    friend constexpr EmulatedExtended& operator-=(EmulatedExtended& a, EmulatedExtended b) noexcept { return a = a - b; }
    friend constexpr EmulatedExtended& operator*=(EmulatedExtended& a, EmulatedExtended b) noexcept { return a = a * b; }
    friend constexpr bool operator<(EmulatedExtended a, EmulatedExtended b) noexcept {
        const EmulatedExtended rest = a - b;
        return rest.exponent_ < not_a_number && rest.negative_ && rest.significand_ != 0;
    }
    friend constexpr bool operator>(EmulatedExtended a, EmulatedExtended b) noexcept { return b < a; }

    friend constexpr EmulatedExtended sqrt(EmulatedExtended x) noexcept {
        if (x.significand_ == 0) return x;
        if (x.negative_ || x.exponent_ >= not_a_number) return nan();
        const int shift = 64 - (x.exponent_ & 1);
        const Wide square = Wide(x.significand_) << shift;
        std::uint64_t root = 0;
        for (std::uint64_t bit = 1ull << 63; bit != 0; bit >>= 1) {
            if (Wide(root | bit) * (root | bit) <= square) root |= bit;
        }
        return rounded(false, Wide(root) + (square - Wide(root) * root > root ? 1 : 0),
                       (x.exponent_ - shift) / 2);  // never halfway between two
    }
    /// Value rounded to the nearest whole number, ties to even.
    friend constexpr EmulatedExtended rint(EmulatedExtended x) noexcept {
        return x.exponent_ >= 0 ? x : rounded(x.negative_, x.without(-x.exponent_), 0);
    }
    /// Fraction of x > 0: 0.5 ≤ result < 1.
    friend constexpr EmulatedExtended frexp(EmulatedExtended x, int* exponent) noexcept {
        *exponent = x.exponent_ + 64;
        return of(x.significand_, x.exponent_ < not_a_number ? -64 : not_a_number);
    }
    friend constexpr EmulatedExtended ldexp(EmulatedExtended x, int twos) noexcept {
        if (x.exponent_ < not_a_number) x.exponent_ += twos;
        return x;
    }

private:
    __extension__ typedef unsigned __int128 Wide;
    static constexpr int not_a_number = 1 << 24;  ///< exponents from here on; those of the set-up are within 1 << 16

    constexpr EmulatedExtended(bool negative, std::uint64_t significand, int exponent) noexcept
        : significand_(significand), exponent_(exponent), negative_(negative) {}

    static constexpr EmulatedExtended nan() noexcept { return {false, 1ull << 63, not_a_number}; }

    /// @param cut whether the number is larger, by less than one unit of a significand whose top bit is one of the highest three
    static constexpr EmulatedExtended rounded(bool negative, Wide significand, int exponent, bool cut = false) noexcept {
        if (exponent >= not_a_number - 128) return nan();
        if (significand == 0) return {negative, 0, 0};
        const auto top = static_cast<std::uint64_t>(significand >> 64);
        const int zeros = top != 0 ? std::countl_zero(top) : 64 + std::countl_zero(static_cast<std::uint64_t>(significand));
        significand <<= zeros;
        auto high = static_cast<std::uint64_t>(significand >> 64);
        const auto low = static_cast<std::uint64_t>(significand);
        constexpr std::uint64_t half = 1ull << 63;
        const bool up = low > half || (low == half && (cut || (high & 1) != 0));
        if (!up || ++high != 0) return {negative, high, exponent - zeros + 64};
        return {negative, half, exponent - zeros + 65};
    }

    /// The significand without its last bits, rounded.
    /// @param bits > 0
    [[nodiscard]] constexpr std::uint64_t without(int bits) const noexcept {
        if (bits > 64) return 0;
        const Wide kept = Wide(significand_) << (64 - bits), half = Wide(1) << 63;
        const auto whole = static_cast<std::uint64_t>(kept >> 64), rest = static_cast<std::uint64_t>(kept);
        return whole + (rest > half || (rest == half && (whole & 1) != 0) ? 1 : 0);
    }

    std::uint64_t significand_ = 0;  ///< highest bit set, except for zero
    int exponent_ = 0;
    bool negative_ = false;
};

using Extended = std::conditional_t<std::numeric_limits<long double>::digits == 64, long double, EmulatedExtended>;

/// significand 2^exponent: a constant whose last bits a double does not have.
template <class Number = Extended>
[[nodiscard]] constexpr Number extended(std::uint64_t significand, int exponent) noexcept {
    if constexpr (std::is_same_v<Number, EmulatedExtended>) {
        return EmulatedExtended::of(significand, exponent);
    } else {
        auto value = static_cast<Number>(significand);
        for (; exponent < 0; ++exponent) value *= 0.5;
        return value;
    }
}

}  // namespace cvtflow::model
