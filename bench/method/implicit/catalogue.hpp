#pragma once
/// The methods that solve with the whole state, by name: trapezoidal-full, …, sw2, ros34pw2, w-x2, …

#include <span>

#include "bench/method/implicit/trapezoidal.hpp"
#include "bench/method/product_names.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

/// One variant of the trapezoidal rule.
struct NewtonVariant {
    const char* name;  ///< trapezoidal-…
    const char* description;
    NewtonOptions options;
};
[[nodiscard]] std::span<const NewtonVariant> newton_variants() noexcept;

/// Rows for method_programs().
[[nodiscard]] std::vector<MethodProgram> implicit_programs();

}  // namespace cvtflow::bench
