#pragma once
/// A number that is zero at compile time: products with it are not computed, sums with it are not changed.

#include <concepts>

namespace cvtflow::model {
namespace {

struct Zero {};

[[nodiscard]] inline Zero operator-(Zero) noexcept { return {}; }
[[nodiscard]] inline Zero operator+(Zero, Zero) noexcept { return {}; }
[[nodiscard]] inline Zero operator-(Zero, Zero) noexcept { return {}; }
[[nodiscard]] inline Zero operator*(Zero, Zero) noexcept { return {}; }

template <class Real>
concept Computed = !std::same_as<Real, Zero>;

/// The number, or 0.
template <Computed Real>
[[nodiscard]] inline Real number(const Real& number) noexcept {
    return number;
}
template <Computed Real>
[[nodiscard]] inline Real number(Zero) noexcept {
    return Real(0.0);
}

template <Computed Real>
[[nodiscard]] inline Zero operator*(const Real&, Zero) noexcept {
    return {};
}
template <Computed Real>
[[nodiscard]] inline Zero operator*(Zero, const Real&) noexcept {
    return {};
}
template <Computed Real>
[[nodiscard]] inline Real operator+(const Real& a, Zero) noexcept {
    return a;
}
template <Computed Real>
[[nodiscard]] inline Real operator+(Zero, const Real& a) noexcept {
    return a;
}
template <Computed Real>
[[nodiscard]] inline Real operator-(const Real& a, Zero) noexcept {
    return a;
}
template <Computed Real>
[[nodiscard]] inline Real operator-(Zero, const Real& a) noexcept {
    return -a;
}

}  // namespace
}  // namespace cvtflow::model
