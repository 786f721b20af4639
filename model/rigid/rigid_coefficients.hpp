#pragma once
/// Numbers of rigid pins, derived once from the parameters. (model/EQUATIONS.md section 11)

#include "model/machine/coefficients.hpp"
#include "model/rigid/rigid_columns.hpp"

namespace cvtflow::model {

/// b √δ_0 up to which the start of Newton's method for tips is within 1e-4 (rigid_tip.hpp).
inline constexpr double well_started_softness = 2.0;

/// β of the filter of the waves along the chain (rigid_links.hpp). Forces of stretch and yaw are at most those of h ω = 1/√(4 β) = 1.9;
/// 0.065 leaves dampers no room below 2, and 0.08 takes some of the longest step.
inline constexpr double wave_filter = 0.07;

struct RigidCoefficients {
    explicit RigidCoefficients(const Parameters& parameters);

    int pins;
    double mass;          ///< mass of a pin with its share of plates [kg]
    double tilt_mass;     ///< inertia of the end displacements p and q [kg]
    double slide_mass;    ///< inertia of ζ: a quarter of the mass [kg]
    double bend_mass;     ///< inertia of bending [kg]
    double half_length;   ///< ℓ_p/2 [m]
    double half_longest;  ///< half of the longest pin's length [m]
    bool unequal;         ///< whether pins differ in length

    // Bending of both halves.
    double bend_share;      ///< displacement of the ends against the mean of the plates, per x_2
    Spring travel, height;  ///< springs against bending along the direction of travel and across, for displacements of the ends
    Spring bow;             ///< spring of a link against the bow: plates and joint in series
    double bend_slope;      ///< q: slope of an end by bending over its slope by tilting, for equal displacements
    double bend_lever;      ///< displacement of a sphere's centre per displacement of the ends by bending

    // Links.
    Spring pull;           ///< plates and joint in series
    double plate_square;   ///< mean ξ² of the plates
    double plate_reach;    ///< ξ̂: root of plate_square
    double arm, diameter;  ///< c_a = ρ - w/2, 2ρ [m]
    double rolling_arm;    ///< a_r over sqrt(N) [m/√N]
    FrictionCurve plate_friction, joint_friction;

    // Tips.
    double sine, cosine;     ///< sin β, cos β
    double radius;           ///< R_p [m]
    double outward;          ///< R_p sin β [m]
    double inverse_reach;    ///< 1/(R_c + R_p) [1/m]
    double touching_radius;  ///< r_m + R_p sin β [m]
    double lever;            ///< 1 - (2/ℓ_p) R_p cos β: displacement of a sphere's centre per end displacement
    double hertz, damping;   ///< K of one tip [N/m^1.5], χ_T [s/m]
    double softness;         ///< b = K cos²β/k_e: axial compliance of half a pin beside Hertz's [1/√m]
    int further_steps;       ///< further iterations of Newton's method, for tips softer than its start is made for
    FrictionCurve tip_friction;
    std::shared_ptr<TipLaw> tip_law;  ///< nullptr: none
    double middle;                    ///< a/2 [m]
    GuideCoefficients guide;

    /// Inertia of coordinate number k [kg].
    [[nodiscard]] constexpr double inertia(int k) const noexcept {
        return k < 3 ? mass : k < 5 ? tilt_mass : k < 6 ? slide_mass : bend_mass;
    }
    /// Whether friction of tips follows a speed that each remembers.
    [[nodiscard]] bool remembers() const noexcept { return tip_law != nullptr && tip_law->memory > 0.0; }
    /// Writes the constants of the links into their columns.
    void fill(const Parameters& parameters, RigidColumns& columns) const;

private:
    /// Sets the coefficients of bending; needs `pull`. @param plate_bow Coefficients::plate_bow
    void bend(const Parameters& parameters, double plate_bow);
};

}  // namespace cvtflow::model
