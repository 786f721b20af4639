#pragma once
/// Links that a step holds against their fastest motions, which would set its length: part of a link's stiffness joins its inertia.
/// (model/EQUATIONS.md section 2)

#include <array>

#include "model/machine/coefficients.hpp"
#include "model/machine/link_inertia.hpp"
#include "model/machine/mirrored_matrix.hpp"

namespace cvtflow::model {

/// Inverse of M + h² K of a link, in its frame.
template <class Number>
struct HeldNumbers {
    MirroredMatrix<Number> along, across, axial;  ///< blocks of x and y along the link and across it, of z and e; equal if none is held
    std::array<Number, axis_terms> turning{};     ///< h² K of the plates on their stretch, by which |d| θ'² counts as one [kg]
};
using HeldInverse = HeldNumbers<double>;

/// Stiffness K = Σ θ K_i of pin halves: plates along the link, bending and extension of halves, joints against modes 2 and 3 of each.
class HeldLinks {
public:
    HeldLinks(const Coefficients& coefficients, const LinkInertia& inertia);

    /// @param step h [s]
    [[nodiscard]] HeldInverse inverse(double step) const noexcept;
    /// Adds factor M⁻¹ K moved to the accelerations of the link at q. q, moved, accelerations: of a link's coordinates
    void add(double factor, const double* q, const double* moved, double* accelerations) const noexcept;

private:
    MirroredMatrix<double> lateral_inertia_, axial_inertia_;  ///< M [kg]
    MirroredMatrix<double> lateral_inverse_, axial_inverse_;  ///< M⁻¹
    MirroredMatrix<double> along_, across_, axial_;           ///< K [N/m]
};

}  // namespace cvtflow::model
