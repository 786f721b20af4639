#pragma once
/// Links that a step holds against their fastest motions, which would set its length: part of a link's stiffness joins its inertia. Waves
/// along the chain, the next fastest, are filtered. (model/EQUATIONS.md section 2)

#include <array>

#include "model/machine/coefficients.hpp"
#include "model/machine/link_inertia.hpp"
#include "model/machine/mirrored_matrix.hpp"

namespace cvtflow::model {

/// A matrix of the modes of an axis, where modes of even and of odd order do not couple.
template <class Number>
using AxisMatrix = std::array<Number, axis_terms * axis_terms>;

/// Inverse of M + h² K of a link, in its frame; and the filter of waves.
template <class Number>
struct HeldNumbers {
    MirroredMatrix<Number> along, across, axial;     ///< blocks of x and y along the link and across it, of z and e; equal if none is held
    std::array<Number, axis_terms> turning{};        ///< h² K of the plates on their stretch, by which |d| θ'² counts as one [kg]
    AxisMatrix<Number> wave_plates{}, wave_joint{};  ///< β h² K of the plates of a link and of a joint; zero: no filter [kg]
};
using HeldInverse = HeldNumbers<double>;

/// Stiffness K = Σ θ K_i of pin halves: plates along the link, bending and extension of halves, joints against modes 2 and 3 of each.
class HeldLinks {
public:
    HeldLinks(const Coefficients& coefficients, const LinkInertia& inertia);

    /// @param step h [s]
    [[nodiscard]] HeldInverse inverse(double step) const noexcept;
    /// β: plates along links and joints act as if they were deflected by u + β h² u''; waves are stable up to h ω = 1/√β. 0, no filter, in
    /// chains with one joint point, whose links are not held, and in those of few pins [1].
    [[nodiscard]] double wave_filter() const noexcept { return filter_; }
    /// Turns accelerations M⁻¹ f of the link at q into those of a step, (M + h² K)⁻¹ f. q, accelerations: of a link's coordinates
    void hold(const HeldInverse& inverse, const double* q, double* accelerations) const noexcept;

private:
    MirroredMatrix<double> lateral_inertia_, axial_inertia_;  ///< M [kg]
    MirroredMatrix<double> along_, across_, axial_;           ///< K [N/m]
    AxisMatrix<double> plates_{}, joint_{};                   ///< K of all plates of a link, and of a joint [N/m]
    double filter_ = 0.0;
};

}  // namespace cvtflow::model
