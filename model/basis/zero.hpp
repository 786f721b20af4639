#pragma once
/// A number that is known to be zero when the code is compiled: what it multiplies is not computed, what it is added to stays as it is.

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
