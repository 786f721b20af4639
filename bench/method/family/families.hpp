#pragma once
/// The tables of the laboratory: classical ones, extrapolation methods, and families whose polynomials are computed.

#include "bench/method/product_names.hpp"
#include "engine/method/catalogue.hpp"

namespace cvtflow::bench {

/// rk38, dopri65, dopri87, euler-x2 …, gbs4 …: tables of numbers, with their orders.
[[nodiscard]] std::vector<StagePlan> further_tables();
/// Some members of each family, with their orders.
[[nodiscard]] std::vector<StagePlan> family_examples();
/// rkc, rock2, rock4, serk2, fitted; members are made with their orders.
[[nodiscard]] std::span<const MethodFamily> families() noexcept;

}  // namespace cvtflow::bench
