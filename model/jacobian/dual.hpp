#pragma once
/// A number with its derivatives in N directions (forward differentiation): forces written in it yield exact Jacobians, kinks of friction
/// laws included, where the branch taken is that of the value.

#include <array>
#include <cmath>

#include "model/basis/ten_ninths.hpp"

namespace cvtflow::model {

template <int N>
struct Dual {
    double value = 0.0;
    std::array<double, N> slope{};

    Dual() noexcept = default;
    Dual(double constant) noexcept : value(constant) {}  // constants are written as numbers in formulas
    /// The variable of one direction.
    static Dual variable(double at, int direction) noexcept {
        Dual d(at);
        d.slope[static_cast<std::size_t>(direction)] = 1.0;
        return d;
    }

    Dual& operator+=(const Dual& b) noexcept { return *this = *this + b; }
    Dual& operator-=(const Dual& b) noexcept { return *this = *this - b; }

    friend Dual operator+(Dual a, const Dual& b) noexcept {
        a.value += b.value;
        for (std::size_t k = 0; k < N; ++k) a.slope[k] += b.slope[k];
        return a;
    }
    friend Dual operator-(Dual a, const Dual& b) noexcept {
        a.value -= b.value;
        for (std::size_t k = 0; k < N; ++k) a.slope[k] -= b.slope[k];
        return a;
    }
    friend Dual operator-(const Dual& a) noexcept { return scaled(a, -a.value, -1.0); }
    friend Dual operator*(const Dual& a, const Dual& b) noexcept {
        Dual product;
        product.value = a.value * b.value;
        for (std::size_t k = 0; k < N; ++k) product.slope[k] = a.slope[k] * b.value + a.value * b.slope[k];
        return product;
    }
    friend Dual operator*(double a, const Dual& b) noexcept { return scaled(b, a * b.value, a); }
    friend Dual operator*(const Dual& a, double b) noexcept { return scaled(a, b * a.value, b); }
    friend Dual operator+(Dual a, double b) noexcept {
        a.value += b;
        return a;
    }
    friend Dual operator+(double a, Dual b) noexcept { return b + a; }
    friend Dual operator-(Dual a, double b) noexcept { return a + (-b); }
    friend Dual operator-(double a, const Dual& b) noexcept { return scaled(b, a - b.value, -1.0); }
    friend Dual inverse(const Dual& a) noexcept {
        const double reciprocal = 1.0 / a.value;
        return scaled(a, reciprocal, -reciprocal * reciprocal);
    }
    friend Dual sqrt(const Dual& a) noexcept {
        const double root = std::sqrt(a.value);
        return scaled(a, root, 0.5 / root);
    }
    /// 0 with derivative 0 where a ≤ 0.
    friend Dual positive_part(const Dual& a) noexcept { return a.value > 0.0 ? a : Dual(); }
    friend Dual ten_ninths(const Dual& a) noexcept {
        if (!(a.value > 0.0)) return {};
        const double result = model::ten_ninths(a.value);
        return scaled(a, result, 10.0 / 9.0 * result / a.value);
    }

private:
    static Dual scaled(const Dual& a, double result, double factor) noexcept {
        Dual out;
        out.value = result;
        for (std::size_t k = 0; k < N; ++k) out.slope[k] = factor * a.slope[k];
        return out;
    }
};

}  // namespace cvtflow::model
