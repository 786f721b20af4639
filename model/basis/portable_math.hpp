#pragma once
/// Functions on which results depend, from additions, multiplications, divisions and roots alone. The C library has several of each and
/// takes one by the processor (with fused operations or without), and they differ in last bits; these are the same everywhere.

#include <cmath>

namespace cvtflow::model {

/// Within one unit of the last place for |x| ≤ 1e4, nearly always rounded correctly. x [1 or rad]
[[nodiscard]] double portable_sin(double x) noexcept;
[[nodiscard]] double portable_cos(double x) noexcept;  ///< x [1 or rad]
/// |x| ≤ 1. x [1 or rad]
[[nodiscard]] double portable_asin(double x) noexcept;
/// x > 0; 0 for x = 0 and y > 0. Within one unit of the last place for |y log x| ≤ 500. x [1 or rad], y [1]
[[nodiscard]] double portable_pow(double x, double y) noexcept;
/// √(x² + y²) of numbers whose squares neither overflow nor vanish: lengths, speeds. x [1], y [1]
[[nodiscard]] inline double portable_hypot(double x, double y) noexcept { return std::sqrt(x * x + y * y); }

}  // namespace cvtflow::model
