#pragma once
/// Broyden's update of an inverse in product form: B⁻¹ = (I + u_k s_kᵀ) … (I + u_0 s_0ᵀ) B_0⁻¹, where the caller provides B_0⁻¹.
/// (C. G. Broyden 1965; product form as in Kelley, Iterative Methods, 1995.) Sums run from the first unknown to the last.

#include <span>
#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

class Broyden {
public:
    /// @param unknowns length of the vectors   @param most updates kept
    Broyden(int unknowns, int most);

    void clear() noexcept { count_ = 0; }
    [[nodiscard]] bool full() const noexcept { return count_ == most_; }
    [[nodiscard]] int count() const noexcept { return count_; }

    /// x ← B⁻¹ B_0 x. @param x [m/s]   @param from first update to apply
    void apply(double* x, int from = 0) const noexcept;
    /// Adds the update of a step s = λ d that turned the residual r into r⁺:  u = (s - w)/(s·w), w = B⁻¹ (r⁺ - r). Ignored if s·w vanishes
    /// or no room is left.
    void add(const double* s, const double* w) noexcept;

    /// Appends the updates to `memory`, takes them back from its front. @return rest of the memory
    void save(std::vector<double>& memory) const;
    [[nodiscard]] std::span<const double> load(std::span<const double> memory);  ///< @param memory from save()

private:
    int unknowns_, most_, count_ = 0;
    std::vector<double> steps_, updates_;  ///< [most][unknowns]
};

}  // namespace cvtflow::bench
