#pragma once
/// A number with its derivatives in N directions (forward differentiation), as lanes with a separate width tag: code over Lanes<W> yields
/// exact Jacobians with W = directions<N>, kinks of friction laws included, where the branch taken is that of the value.

#include <array>
#include <cmath>

#include "model/basis/lanes.hpp"
#include "model/basis/portable_math.hpp"

namespace cvtflow::model {
namespace {

/// The width tag of one number with N derivatives.
template <int N>
inline constexpr int directions = -N;

template <int W>
requires(W < 0) struct Lanes<W> {
    static constexpr std::size_t count = -W;
    double value = 0.0;
    std::array<double, count> slope{};  ///< derivatives by direction

    Lanes() noexcept = default;
    Lanes(double constant) noexcept : value(constant) {}  // constants are written as numbers in formulas
    /// The variable of one direction.
    static Lanes variable(double at, int direction) noexcept {
        Lanes d(at);
        d.slope[static_cast<std::size_t>(direction)] = 1.0;
        return d;
    }

    friend Lanes& operator+=(Lanes& a, const Lanes& b) noexcept { return a = a + b; }
    friend Lanes& operator-=(Lanes& a, const Lanes& b) noexcept { return a = a - b; }

    friend Lanes operator+(Lanes a, const Lanes& b) noexcept {
        a.value += b.value;
        for (std::size_t k = 0; k < count; ++k) a.slope[k] += b.slope[k];
        return a;
    }
    friend Lanes operator-(Lanes a, const Lanes& b) noexcept {
        a.value -= b.value;
        for (std::size_t k = 0; k < count; ++k) a.slope[k] -= b.slope[k];
        return a;
    }
    friend Lanes operator-(const Lanes& a) noexcept { return a.mapped(-a.value, -1.0); }
    /// Compiled once per width: the many products of an element are not worth their code side by side.
    [[gnu::noinline]] friend Lanes operator*(const Lanes& a, const Lanes& b) noexcept {
        Lanes product;
        product.value = a.value * b.value;
        for (std::size_t k = 0; k < count; ++k) product.slope[k] = a.slope[k] * b.value + a.value * b.slope[k];
        return product;
    }
    friend Lanes operator*(double a, const Lanes& b) noexcept { return b.mapped(a * b.value, a); }
    friend Lanes operator*(const Lanes& a, double b) noexcept { return a.mapped(b * a.value, b); }
    friend Lanes operator+(Lanes a, double b) noexcept {
        a.value += b;
        return a;
    }
    friend Lanes operator+(double a, Lanes b) noexcept { return b + a; }
    friend Lanes operator-(Lanes a, double b) noexcept { return a + (-b); }
    friend Lanes operator-(double a, const Lanes& b) noexcept { return b.mapped(a - b.value, -1.0); }
    friend Lanes operator/(double a, const Lanes& b) noexcept {
        const double reciprocal = 1.0 / b.value;
        return b.mapped(a * reciprocal, -a * reciprocal * reciprocal);
    }
    friend Lanes operator/(const Lanes& a, double b) noexcept { return a.mapped(a.value / b, 1.0 / b); }
    friend Lanes sqrt(const Lanes& a) noexcept {
        const double root = std::sqrt(a.value);
        return a.mapped(root, 0.5 / root);
    }
    friend Lanes abs(const Lanes& a) noexcept { return a.value < 0.0 ? -a : a; }

    /// A function of this number. @param result its value   @param derivative its derivative
    [[nodiscard]] Lanes mapped(double result, double derivative) const noexcept {
        Lanes out;
        out.value = result;
        for (std::size_t k = 0; k < count; ++k) out.slope[k] = derivative * slope[k];
        return out;
    }
};

template <int W>
requires(W < 0) [[nodiscard]] inline Lanes<W> select_greater(const Lanes<W>& a, const Lanes<W>& b, const Lanes<W>& chosen,
                                                             const Lanes<W>& otherwise) noexcept {
    return a.value > b.value ? chosen : otherwise;
}
template <int W>
requires(W < 0) [[nodiscard]] inline Lanes<W> larger(const Lanes<W>& a, const Lanes<W>& b) noexcept { return a.value > b.value ? a : b; }
template <int W>
requires(W < 0) [[nodiscard]] inline Lanes<W> smaller(const Lanes<W>& a, const Lanes<W>& b) noexcept { return a.value < b.value ? a : b; }
template <int W>
requires(W < 0) inline void take(const Lanes<W>& from, std::size_t /*lane*/, Lanes<W>& to) noexcept { to = from; }
/// limit [unit of the quantity]
template <int W>
requires(W < 0) [[nodiscard]] inline bool all_at_most(const Lanes<W>& a, double limit) noexcept { return a.value <= limit; }
/// x^(10/9), 0 with derivative 0 where x ≤ 0.
template <int W>
requires(W < 0) [[nodiscard]] inline Lanes<W> ten_ninths(const Lanes<W>& x) noexcept {
    if (!(x.value > 0.0)) return {};
    const double result = ten_ninths(x.value);
    return x.mapped(result, 10.0 / 9.0 * result / x.value);
}

/// A number with N derivatives.
template <int N>
using Dual = Lanes<directions<N>>;

}  // namespace
}  // namespace cvtflow::model
