#pragma once
/// Numbers derived once from the parameters, for the kernels. Immutable during a run.

#include <array>
#include <memory>
#include <vector>

#include "model/basis/isa.hpp"
#include "model/law/friction.hpp"
#include "model/parameters/chain_layout.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

inline constexpr int max_plate_lanes = 64;
inline constexpr int max_joint_lanes = 16;

/// A spring with its viscous partner.
struct Spring {
    double stiffness = 0.0;  ///< [N/m] or [N·m/rad]
    double damping = 0.0;    ///< [N·s/m] or [N·m·s/rad]
};
/// c = 2 ζ sqrt(k m).
[[nodiscard]] Spring damped_spring(double stiffness, double effective_mass, double damping_ratio) noexcept;

/// Numbers that differ between links of different pitch.
struct LinkKind {
    double free_length;              ///< ℓ_0 = pitch + w [m]
    double inverse_length;           ///< 1/ℓ_0 [1/m]
    Spring bending, shear, torsion;  ///< plate pack
};

/// Points along ξ, those at ξ and -ξ equally far from the ends of the list. Sums over them have the tree of lanes side by side; lanes
/// beyond the count are padding.
template <int Most, class Number = double>
struct PointLanes {
    int count = 0;                                    ///< real points
    int width = 0;                                    ///< lanes of one chunk, a power of two ≤ 16; chunks = ceil(count/width)
    alignas(64) std::array<Number, Most> position{};  ///< ξ [1]
    alignas(64) std::array<Number, Most> weight{};    ///< stiffness or quadrature weight, 0 on padding
    alignas(64) std::array<Number, Most> damping{};   ///< [N·s/m], 0 on padding
    alignas(64) std::array<std::array<Number, Most>, axis_terms> basis{};  ///< P_m(ξ)
};

/// Springs of the bending modes m = 2…p of both halves: rear 2…p, front 2…p.
struct BendingLanes {
    alignas(32) std::array<double, 4> stiffness{}, damping{};
};

struct TipCoefficients {
    double sine, cosine;     ///< sin β, cos β
    double radius;           ///< R_p [m]
    double reach;            ///< R_c + R_p [m]
    double touching_radius;  ///< r_m + R_p sin β: radius of the sphere's centre when it touches at r_m
    double hertz, damping;   ///< K [N/m^1.5], χ_T [s/m]
    FrictionCurve friction;
    std::shared_ptr<TipLaw> law;  ///< nullptr: friction depends on speed by the curve alone
};

struct JointCoefficients {
    double arm;                 ///< c_a = ρ - w/2 [m]
    double diameter;            ///< 2ρ [m]
    double stiffness, damping;  ///< k_J [N/m], χ_J [s/m]
    bool palmgren;
    double reference_depth;                                    ///< [m]
    double clearance, clearance_stiffness, clearance_damping;  ///< c_g, k_g, χ_g [m, N/m, s/m]
    FrictionCurve friction;
    double rolling_arm;  ///< a_r over sqrt(N): sliding per angle between the links, of rigid pins [m/√N]
};

/// Guides of the strands. s: along the tangent, from where the driving pulley leaves it; u: outwards, from the middle between the rails.
struct GuideCoefficients {
    bool present = false;
    double stiffness, damping, clearance, friction;  ///< k [N/m], χ [s/m], c [m], μ
    double per_full_speed;                           ///< 1/(speed from which friction is full) [s/m]
    double sine, cosine;                             ///< sin φ, cos φ of the tangent's slope: sin φ = (r_2 - r_1)/a
    double radius;                                   ///< r_1 + o [m]
    double begin, end;                               ///< beginning and end of the rails, along s [m]
    double per_ramp;                                 ///< 1/(length over which the stiffness grows at either end) [1/m]
};

struct Coefficients {
    explicit Coefficients(const Parameters& parameters);

    ChainLayout layout;
    double half_length;  ///< ℓ_p/2 [m]
    double slope_scale;  ///< 2/ℓ_p [1/m]
    Spring extension;
    BendingLanes travel, height;  ///< bending of both halves
    std::vector<LinkKind> kinds;  ///< distinct links
    std::vector<int> kind_of;     ///< [links] index into kinds
    PointLanes<max_plate_lanes> plates;
    FrictionCurve plate_friction;
    PointLanes<max_joint_lanes> joint_points;
    JointCoefficients joint;
    TipCoefficients tip;
    GuideCoefficients guide;
    SpeedProfile clamping_limit;  ///< limit over the slip speed; 0 everywhere: none [N]
    bool eccentric;               ///< whether a flank moves as its shaft turns
    std::vector<double> longer;   ///< [pins] excess of half a pin's length over ℓ_p/2; empty: all are equal [m]
    double middle;                ///< a/2: links with smaller x belong to shaft 0 [m]
    double centre_distance;       ///< a [m]
    double plate_bow;             ///< mean over the plates of P_2: shift of x_0 of a rigid pin against that of a half

    [[nodiscard]] const LinkKind& kind(int link) const noexcept {
        return kinds[static_cast<std::size_t>(kind_of[static_cast<std::size_t>(link)])];
    }
};

/// Positions ξ_j of the plates as they are resolved (each or lumped); their number represents the totals of the pack.
[[nodiscard]] std::vector<double> plate_positions(const Parameters& parameters);

/// Excess of half of each pin's length over half.length/2 [pins]: drawn from a normal distribution that is cut at three times its standard
/// deviation. Empty if pins are equal. [m]
[[nodiscard]] std::vector<double> longer_halves(const Parameters& parameters);

/// Factor on the inertia of the bending of rigid pins, which a step of 5 us could not follow otherwise. Statics stay.
/// (model/EQUATIONS.md section 11)
inline constexpr double rigid_bending_inertia = 8.0;

}  // namespace cvtflow::model
