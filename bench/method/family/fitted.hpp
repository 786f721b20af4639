#pragma once
/// Explicit methods whose stability polynomial is fitted to a spectrum: sums of the stages of an RKC recurrence that is stretched over the
/// target real interval. Their stages stay bounded there and errors made in a stage hardly grow, unlike those of factorised polynomials.
///
///     Y_j(z) = a_j + b_j T_j(w0 + w1 z),  y' = Σ alpha_j Y_j,  w1 = (1 + w0)/(1.03 L)
///
/// The weights alpha minimise max |R(z_i)|/bound_i over points of the spectrum by Lawson's iteration (least squares, weights multiplied by
/// the residuals), among those that satisfy the order conditions of linear problems. That takes milliseconds, so a method can be made when
/// it is needed. The other condition of order 3, b·c² = 1/3, then holds to some 1e-6 without being imposed; imposing it, which is
/// nearly the same condition again, takes weights so large that the real interval falls from 204 to 4 (measured).

#include <complex>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "bench/method/product_names.hpp"
#include "engine/method/stage_plan.hpp"

namespace cvtflow::bench {

/// Stages of a Runge-Kutta-Chebyshev recurrence over a chosen real interval, as a basis for stability polynomials.
/// Source: Sommeijer, Shampine, Verwer, J. Comput. Appl. Math. 88 (1998) 315-326, with w1 from the interval instead of T'/T''.
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

/// Region for which a fitted method shall be stable, in units of h λ.
struct FitRequest {
    double real = 200.0;          ///< L: the real interval [-L, 0]
    double imaginary = 2.0;       ///< W: |z| up to W with at least the damping ratio below
    int order = 3;                ///< 2 or 3
    double ripple = 0.2;          ///< |R| allowed on [-L, -4]
    double damping_ratio = 0.01;  ///< smallest damping ratio of oscillations

    bool operator==(const FitRequest&) const = default;
};

struct FittedMethod {
    StagePlan plan;
    int iterations = 0;    ///< iterations of Lawson's method
    double largest = 0.0;  ///< max |R(z_i)|/bound_i at its end: ≤ 1 [1]
};

inline constexpr int min_fitted_stages = 4;
inline constexpr int max_fitted_stages = 150;
inline constexpr double min_fitted_real = 5.0;        ///< [1]
inline constexpr double max_fitted_real = 8000.0;     ///< [1]
inline constexpr double max_fitted_imaginary = 50.0;  ///< [1]

/// The fitted method with `stages` stages; nothing if none meets the request.
/// @throws std::invalid_argument if the request or the stages are outside the limits
[[nodiscard]] std::optional<FittedMethod> fit(const FitRequest& request, int stages);
/// The one with the fewest stages; nothing if max_fitted_stages do not do.
[[nodiscard]] std::optional<FittedMethod> fit(const FitRequest& request);
/// fitted-l<L>-w<W>[-s<stages>][-p<order>][-r<ripple>], e.g. fitted-l200-w2; nothing if it is no such name, out of the limits or cannot be
/// met.
[[nodiscard]] std::optional<StagePlan> fitted_by_name(std::string_view name);

}  // namespace cvtflow::bench
