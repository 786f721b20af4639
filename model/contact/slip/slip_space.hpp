#pragma once
/// Implicit friction as a convex problem in slips. With contacts frozen (ContactField) and velocities v̂ before friction acts, a stage of
/// an implicit method solves
///
///     A (v - v̂) + g Σ Tᵀ φ(T v - s) = 0        g = γ h;  T v - s: slip of a contact, two components;  φ: its friction force
///
/// which is the minimum of ½ (v-v̂)ᵀ A (v-v̂) + g Σ Φ(T v - s). In slips w and forces λ = φ(w), with W = T A⁻¹ Tᵀ:   w = ŵ - g W λ.
/// W couples the contacts of a link, and the joints at its two ends. Newton: λ = φ(w) + R x with x = Rᵀ (w_new - w) and φ'(w) = R Rᵀ:
///
///     (1 + g Rᵀ W R) x = Rᵀ (ŵ - g W φ(w) - w)      symmetric, all eigenvalues ≥ 1
///
/// Plates and tips are eliminated inside their link, what is left are joints: cyclic block-tridiagonal, two numbers per integration point.
/// Slips and forces are doubles; matrices are floats, since x vanishes as w converges.
///
/// Links that are far from each other lie side by side in lanes: lane s holds stretch s of the chain, group k the k-th link of every
/// stretch. A group works on its links alone. Then one task eliminates the joints inside the stretches, group by group, all stretches side
/// by side; then every other joint of those at the stretches' ends, and so on until one is left; and back.

#include <array>
#include <span>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "model/contact/slip/joint_chain.hpp"

namespace cvtflow::model {

/// Numbers of a link's contacts. A contact has two slips, rows 2k and 2k + 1: plates as one (gaps z' and e'), tips (two tangents of the
/// sheave), then points of the rear joint, then of the front joint (across, axial).
struct SlipContacts {
    int points;  ///< integration points of a joint
    static constexpr int plates = 0, first_tip = 1, first_joint = 5;

    [[nodiscard]] constexpr int count() const noexcept { return first_joint + 2 * points; }
    [[nodiscard]] constexpr int slips() const noexcept { return 2 * count(); }
    [[nodiscard]] constexpr int joint(End end, int point) const noexcept { return first_joint + (end == End::rear ? 0 : points) + point; }
    /// Slips of one joint.
    [[nodiscard]] constexpr int joint_slips() const noexcept { return 2 * points; }
    static constexpr int local_slips = 2 * first_joint;  ///< those of plates and tips come first
};

/// Contacts and unknowns of a group of links.
struct SlipGroup {
    SlipGroup(const ChainModel& chain, const SlipStretches& stretches, int number);

    struct Link {
        int number, lane;
    };
    std::vector<Link> links;               ///< that do not idle
    std::array<int, slip_lanes> column{};  ///< of a contact field, for every lane
    bool touching = false;                 ///< some tip touches
    /// Rows of a tip: tangents, their levers/|d0|, the sheave's velocity along them and its change over the step, μN, 1 where it must
    /// stick.
    struct Tip {
        static constexpr int tangent = 0, lever = 6, sheave = 8, drift = 10, friction_limit = 12, sticks = 13, count = 14;
    };
    /// Rows of a joint's point.
    struct Point {
        static constexpr int normal_x = 0, normal_y = 1, lever = 2, friction_limit = 3, count = 4;
    };
    LaneRows present;                      ///< 1, or 0 where the lane idles: no contact grips there
    LaneRows frame, tips, joints, plates;  ///< t; [4 Tip]; [rear, front][points Point]; μN
    FloatRows coupling;                    ///< g W, triangle
    double step = 0.0;                     ///< g [s]
    LaneRows velocity;                     ///< v̂, or the velocity whose slips are requested [link_size]
    LaneRows acceleration;                 ///< -A⁻¹ Tᵀ λ [link_size]
    LaneRows predicted;                    ///< this link's part of ŵ
    LaneRows own, link_slip_at_start;      ///< this link's part of a slip; of one where the step begins
    LaneRows slip, force, law_force;       ///< w, λ at hand, φ(w)
    LaneRows part;                         ///< ŵ - g W φ(w), this link's part
    LaneRows next_slip, next_force;        ///< of a whole Newton step
    LaneRows solved_slip;                  ///< w of the last solution with higher saturation speeds
    FloatRows root;                        ///< R [contact][4]
    FloatRows factor, panel;  ///< elimination inside a link: L with D⁻¹ on its diagonal; L⁻¹ [Rᵀ g W R of joints | right-hand side]
    FloatRows element;        ///< SlipElement, without right-hand sides of the joints themselves
    double continuation = 1.0;                     ///< saturation speeds are taken so many times as high [1]
    double slope_before = 0.0, slope_after = 0.0;  ///< of the energy along the Newton step, at its start and where it was evaluated [W]
    double residual = 0.0;                         ///< largest change of slip that a contact's force is off [m/s]
};

class SlipSpace;

/// Functions of one order, number of points and instruction set.
struct SlipKernels {
    using OnGroup = void (*)(const SlipSpace&, SlipGroup&) noexcept;
    void (*gather)(const SlipSpace&, const ContactField&, const Phase*, double g, SlipGroup&) noexcept;  ///< g [s]
    void (*slips)(const SlipSpace&, double time, SlipGroup&, LaneRows&) noexcept;                        ///< time [1]
    OnGroup forces, accelerate, linearise, eliminate;
    void (*respond)(const SlipSpace&, const LaneRows& force, SlipGroup&, LaneRows&) noexcept;
    void (*join)(const SlipSpace&, std::span<const SlipGroup>, SlipChain&) noexcept;
    void (*substitute)(const SlipSpace&, const float* unknowns, SlipGroup&) noexcept;
    void (*search)(const SlipSpace&, double share, SlipGroup&) noexcept;  ///< share [1]
};

/// Constants of slips and forces for one chain, and the kernels that work on groups. @param chain must outlive this
class SlipSpace {
public:
    SlipSpace(const ChainModel& chain, bool by_phase);

    /// Takes the contacts of a group's links from a field, and makes g W. @param phases of the whole chain
    void gather(const ContactField& field, const Phase* phases, double g, SlipGroup& group) const noexcept {
        kernels_.gather(*this, field, phases, g, group);
    }
    /// Each link's part of the slips at group.velocity, into `own`. @param time of the velocities, from the middle of the step, in steps
    void slips(double time, SlipGroup& group, LaneRows& own) const noexcept { kernels_.slips(*this, time, group, own); }
    /// λ = φ(w) at group.slip.
    void forces(SlipGroup& group) const noexcept { kernels_.forces(*this, group); }
    /// Accelerations by group.force.
    void accelerate(SlipGroup& group) const noexcept { kernels_.accelerate(*this, group); }
    /// Newton's matrix at group.slip, reduced to the group's joints.
    void eliminate(SlipGroup& group) const noexcept {
        kernels_.linearise(*this, group);
        kernels_.respond(*this, group.law_force, group, group.part);
        kernels_.eliminate(*this, group);
    }
    /// Solves for all joints, from all groups.
    void join(std::span<const SlipGroup> groups, SlipChain& chain) const noexcept { kernels_.join(*this, groups, chain); }
    /// next_force, and `own` parts of the next slips. @param unknowns of the group's rear and front joints
    void substitute(const float* unknowns, SlipGroup& group) const noexcept {
        kernels_.substitute(*this, unknowns, group);
        kernels_.respond(*this, group.next_force, group, group.own);
    }
    /// The energy's slope along the step, and what is left, at a share of it in [0, 1].
    void search(double share, SlipGroup& group) const noexcept { kernels_.search(*this, share, group); }

    [[nodiscard]] const ChainModel& chain() const noexcept { return friction_.chain(); }
    [[nodiscard]] const FrictionOperator& friction() const noexcept { return friction_; }
    [[nodiscard]] const SlipContacts& contacts() const noexcept { return contacts_; }
    [[nodiscard]] const FrictionCurve& tip_curve() const noexcept { return tip_curve_; }
    /// Directions in which contacts act on a link's x or y: ends of halves (corner/2, ±1), rear points, front points, turning; and on z and
    /// e: corners, rear points, front points, gap z, gap e.
    [[nodiscard]] int turning() const noexcept { return 4 + 2 * contacts_.points; }
    /// dᵀ A⁻¹ d' of two of them.
    [[nodiscard]] double lateral(int a, int b) const noexcept { return lateral_gram_[static_cast<std::size_t>(a * (turning() + 1) + b)]; }
    [[nodiscard]] double axial(int a, int b) const noexcept { return axial_gram_[static_cast<std::size_t>(a * (turning() + 2) + b)]; }

private:
    FrictionOperator friction_;
    SlipContacts contacts_;
    FrictionCurve tip_curve_;
    std::vector<double> lateral_gram_, axial_gram_;  ///< [direction][direction], over mass [1/kg]
    SlipKernels kernels_;
};

}  // namespace cvtflow::model
