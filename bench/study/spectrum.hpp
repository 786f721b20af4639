#pragma once
/// Eigenvalues of the equations of motion at a state, which a method has to cope with; and their attribution to kinds of contact, by
/// changes of saturation speeds.

#include <array>
#include <complex>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/method/analysis/eigenvalues.hpp"
#include "model/variator/variator.hpp"
#include "tasks/step/integration_state.hpp"

namespace cvtflow::bench {

/// Central differences of the right-hand side at (t, state) with frozen phases: [size * size], column by column (d f / d y_k contiguous).
/// Steps: 1e-9 m (rad) for coordinates, 1e-6 m/s (rad/s) for velocities: small against contact depths and saturation speeds.
[[nodiscard]] std::vector<double> jacobian(const model::Variator& variator, double t, const std::vector<double>& state,
                                           const std::vector<model::Phase>& phases);

/// All eigenvalues of the Jacobian [1/s], sorted by real part, most negative first. Dense QR: about a second for 650 unknowns, some minutes
/// for 3,400.
[[nodiscard]] std::vector<std::complex<double>> spectrum(const model::Variator& variator, double t, const std::vector<double>& state,
                                                         const std::vector<model::Phase>& phases);

/// A kind of contact with separate friction parameters.
struct ContactKind {
    std::string_view name;
    model::Friction& (*friction)(model::Parameters&);
};

inline constexpr int contact_kind_count = 3;
/// Joints, plates, tips.
[[nodiscard]] std::span<const ContactKind, contact_kind_count> contact_kinds() noexcept;

/// Summary of a spectrum in one line.
struct Extent {
    double decay = 0.0;        ///< max(-Re λ) [1/s]
    double oscillation = 0.0;  ///< max|Im λ| [1/s]
    int below_1e6 = 0;         ///< eigenvalues with Re λ < -1e6 1/s
    int below_1e7 = 0;         ///< eigenvalues with Re λ < -1e7 1/s
    int growing = 0;           ///< eigenvalues with Re λ > growth_rate_tolerance; slower growth may be rounding of the differences
    double growth = 0.0;       ///< max(Re λ), or 0 [1/s]
};

[[nodiscard]] Extent extent_of(const bench::Eigenvalues& values) noexcept;

/// The spectrum with the saturation speeds of some kinds of contact ten times as high.
struct SlowedSpectrum {
    std::string contacts;       ///< "joints", "joints, plates"; empty: as the scene has it
    bench::Eigenvalues values;  ///< left of the border, and the pair that oscillates fastest
};

struct Attribution {
    bench::Eigenvalues values;                                   ///< left of the border, most negative first
    std::vector<std::array<double, contact_kind_count>> shares;  ///< -d ln λ / d ln v0 of each value by kind; friction alone: they sum to 1
    std::vector<SlowedSpectrum> slowed;                          ///< none, each kind alone, then joints with plates, all three
    [[nodiscard]] int main_kind(std::size_t value) const;        ///< the kind with the largest share
};

/// Nine times the work of extremal_eigenvalues(). @param border [1/s], < 0   @param progress called with the present activity; may be empty
[[nodiscard]] Attribution attribute(const model::Parameters& parameters, const tasks::FrozenStart& start, double border,
                                    const std::function<void(const std::string&)>& progress);

}  // namespace cvtflow::bench
