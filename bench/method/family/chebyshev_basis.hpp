#pragma once
/// Stages of a Runge-Kutta-Chebyshev recurrence over a chosen real interval, as a basis for stability polynomials.
/// Source: Sommeijer, Shampine, Verwer, J. Comput. Appl. Math. 88 (1998) 315-326, with w1 from the interval instead of T'/T''.

#include <complex>
#include <span>
#include <vector>

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

class ChebyshevBasis {
public:
    /// @param stages s ≥ 2   @param length of the real interval on which all stages stay bounded
    ChebyshevBasis(int stages, double length);

    [[nodiscard]] int stages() const noexcept { return stages_; }
    /// Y_j(z), j = 0 … s.
    void evaluate(std::complex<double> z, std::span<std::complex<double>> values) const noexcept;
    /// The p-th derivative of Y_j at 0, p = 0 … 3.
    [[nodiscard]] double derivative(int j, int p) const noexcept;
    /// The plan whose result is Σ alpha_j Y_j, evaluated there for the next step and the error estimate of RKC.
    /// @param alpha [s + 1], sum 1
    [[nodiscard]] StagePlan plan(std::span<const double> alpha) const;

private:
    [[nodiscard]] double b(int j) const noexcept;
    [[nodiscard]] Stage row(int j) const;

    int stages_;
    double w0_, w1_;            ///< damping point and its share in the argument [1]
    std::vector<double> t_[4];  ///< T_j and three derivatives at w0 [1]
};

}  // namespace cvtflow::bench
