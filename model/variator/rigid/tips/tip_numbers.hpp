#pragma once
/// Numbers of the tips of rigid pins, once per step for all of them. (model/EQUATIONS.md section 11)

#include "model/variator/rigid/rigid_coefficients.hpp"
#include "model/variator/rigid/rigid_vectors.hpp"

namespace cvtflow::model {
namespace {

/// Numbers of all tips, as wide as what is computed with them: derived once per pass and not for each tip.
template <int W>
struct TipNumbers {
    TipNumbers(const RigidCoefficients& c, const RigidKick& kick) noexcept
        : radius(c.radius),
          inverse_reach(c.inverse_reach),
          softness(c.softness),
          hertz(c.hertz),
          damping(c.damping),
          per_cosine(1.0 / c.cosine),
          lever(c.lever),
          outward(c.outward),
          inward(c.radius * c.cosine),
          stiffness(c.cosine * c.hertz / c.softness),
          outward_per_half(c.outward / c.half_length),
          per_half(1.0 / c.half_length),
          bend_lever(c.bend_lever),
          bent_outward_per_half(c.bend_slope * c.outward / c.half_length),
          bent_per_half(c.bend_slope / c.half_length),
          per_mass(kick.step / c.mass),
          per_half_mass(2.0 * kick.step / c.mass),
          per_tilt(kick.step / c.tilt_mass),
          per_bend(kick.step / c.bend_mass),
          response(1.1 * kick.step * (1.0 / c.mass + 1.0 / c.tilt_mass + 1.0 / c.bend_mass)),
          further_steps(c.further_steps + (kick.implicit() ? 0 : 1)) {}

    Lanes<W> radius, inverse_reach, softness, hertz, damping, per_cosine, lever, outward;  ///< as of RigidCoefficients
    Lanes<W> inward;                                                                       ///< R_p cos β [m]
    Lanes<W> stiffness;                                                                    ///< of a tip against depth, per η [N/m]
    Lanes<W> outward_per_half;                                                             ///< R_p sin β/(ℓ_p/2)
    Lanes<W> per_half;                                                                     ///< 1/(ℓ_p/2) [1/m]
    Lanes<W> bend_lever;                                                                   ///< as of RigidCoefficients
    Lanes<W> bent_outward_per_half, bent_per_half;                                         ///< the same for bending
    Lanes<W> per_mass, per_half_mass, per_tilt, per_bend;                                  ///< velocity per force over the step [m/s/N]
    Lanes<W> response;  ///< of the sliding velocity to friction, with some room for neighbours [m/s/N]
    int further_steps;  ///< of Newton's method
};

}  // namespace
}  // namespace cvtflow::model
