#pragma once
/// Stands in for model/basis/native_lanes.hpp where the kernels are compiled for comparison as plain scalar code: vectors of one lane.

#include <array>
#include <cstddef>
#include <utility>

#include "model/basis/isa.hpp"

namespace cvtflow::model {
namespace {

inline constexpr int native_lanes = 1;
#ifdef CVTFLOW_ONE_LANE  // a program with these kernels, as its baseline
inline constexpr Isa compiled_isa = Isa::baseline;
inline constexpr bool slopes_alone = false;
#else  // no instruction set of the program: only the bench knows it
inline constexpr Isa compiled_isa = static_cast<Isa>(-1);
inline constexpr bool slopes_alone = true;
#endif

template <int W>
struct NativeVector {
    using Type = double;
};

template <int W>
[[nodiscard]] inline double native_sqrt(double v) noexcept {
    return __builtin_sqrt(v);
}
template <int W>
[[nodiscard]] inline double native_abs(double v) noexcept {
    return __builtin_fabs(v);
}
template <int W>
[[nodiscard]] inline double native_larger(double a, double b) noexcept {
    return a > b ? a : b;
}

template <int W>
[[nodiscard]] inline double native_smaller(double a, double b) noexcept {
    return a < b ? a : b;
}

template <int W>
[[nodiscard]] inline bool native_all_at_most(double v, double limit) noexcept {
    return v <= limit;
}
template <int W>
[[nodiscard]] double native_half(double v, int) noexcept;  // never used: one lane has no halves
template <int W>
[[nodiscard]] double native_join(double low, double high) noexcept;
template <int W, int by, int... lane>
[[nodiscard]] double native_slide(double low, double high, std::integer_sequence<int, lane...>) noexcept;
template <int W, int half, int... lane>
void native_exchange(double& a, double& b, std::integer_sequence<int, lane...>) noexcept;
template <int W, int group>
[[nodiscard]] double native_transposed_sum(const std::array<double, static_cast<std::size_t>(group)>& v) noexcept;

}  // namespace
}  // namespace cvtflow::model
