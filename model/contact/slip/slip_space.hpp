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

namespace cvtflow::model {

/// Links of a group, side by side in lanes.
inline constexpr int slip_lanes = 16;

/// Rows of slip_lanes numbers each, one lane per link, on cache lines of their own.
template <class Number>
class RowsOf {
public:
    RowsOf() = default;
    explicit RowsOf(int rows) : memory_(static_cast<std::size_t>(rows * slip_lanes), Number(0)) {}
    [[nodiscard]] Number* at(int row) noexcept { return memory_.data() + row * slip_lanes; }
    [[nodiscard]] const Number* at(int row) const noexcept { return memory_.data() + row * slip_lanes; }

private:
    LineVector<Number> memory_;
};
using LaneRows = RowsOf<double>;
using FloatRows = RowsOf<float>;

/// Which links lie side by side. Stretches are as long as possible alike; shorter ones have no link in group 0, where their lane idles.
class SlipStretches {
public:
    explicit SlipStretches(int links) noexcept
        : links_(links), count_(links < slip_lanes ? links : slip_lanes), length_((links + count_ - 1) / count_) {}

    struct Place {
        int group, lane;
    };
    /// Stretches, and links of the longest of them, which is the number of groups.
    [[nodiscard]] int count() const noexcept { return count_; }
    [[nodiscard]] int length() const noexcept { return length_; }
    [[nodiscard]] bool idle(Place p) const noexcept { return p.lane >= count_ || p.group < first_group(p.lane); }
    /// The group of a stretch's first link: 0 or 1.
    [[nodiscard]] int first_group(int lane) const noexcept { return length_ - (first_link(lane + 1) - first_link(lane)); }
    /// The link at a place; of one that idles: some link nearby.
    [[nodiscard]] int link(Place p) const noexcept {
        const int lane = p.lane < count_ ? p.lane : count_ - 1;
        return first_link(lane) + (idle({p.group, lane}) ? 0 : p.group - first_group(lane));
    }
    /// Where the neighbours of the link at a place are.
    [[nodiscard]] Place before(Place p) const noexcept {
        if (p.group > 0 && p.group > first_group(p.lane)) return {p.group - 1, p.lane};
        return {length_ - 1, p.lane == 0 ? count_ - 1 : p.lane - 1};
    }
    [[nodiscard]] Place after(Place p) const noexcept {
        if (p.group + 1 < length_) return {p.group + 1, p.lane};
        const int lane = p.lane + 1 == count_ ? 0 : p.lane + 1;
        return {first_group(lane), lane};
    }

private:
    [[nodiscard]] int first_link(int lane) const noexcept { return links_ * lane / count_; }
    int links_, count_, length_;
};

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
/// Entry (row, column ≤ row) of a lower triangle stored row by row.
[[nodiscard]] constexpr int triangle(int row, int column) noexcept { return row * (row + 1) / 2 + column; }

/// What two neighbouring joints have of each other, a link or a row of links between them: rows of floats.
struct SlipElement {
    int size;  ///< unknowns of a joint
    /// First rows of blocks [size][size]: of both ends, of which what is above the diagonal does not count, and of the front joint on the
    /// rear one.
    [[nodiscard]] constexpr int rear() const noexcept { return 0; }
    [[nodiscard]] constexpr int across() const noexcept { return size * size; }
    [[nodiscard]] constexpr int front() const noexcept { return 2 * size * size; }
    /// Of right-hand sides [size].
    [[nodiscard]] constexpr int rear_side() const noexcept { return 3 * size * size; }
    [[nodiscard]] constexpr int front_side() const noexcept { return rear_side() + size; }
    [[nodiscard]] constexpr int count() const noexcept { return front_side() + size; }
};

/// What is kept of a joint that has been eliminated between two others: M = L D Lᵀ, L⁻¹ [on the joint before | on the next | right-hand
/// side].
struct SlipStep {
    int size;
    [[nodiscard]] constexpr int factor(int row, int column) const noexcept {
        return triangle(row, column);
    }  ///< L, and D⁻¹ on its diagonal
    [[nodiscard]] constexpr int panel(int row, int column) const noexcept { return triangle(size, 0) + (2 * size + 1) * row + column; }
    [[nodiscard]] constexpr int count() const noexcept { return panel(size, 0); }
};

/// The joints of the whole chain.
struct SlipChain {
    SlipChain(const SlipStretches& stretches, int size);
    /// Times that every other joint between stretches is eliminated, until one is left.
    [[nodiscard]] int levels() const noexcept { return static_cast<int>(counts.size()) - 1; }

    SlipStretches stretches;
    std::vector<int> counts;       ///< joints between stretches that are left [level]
    std::vector<FloatRows> steps;  ///< [joint inside a stretch - 1, then level] SlipStep
    FloatRows left, right;         ///< SlipElement at work
    FloatRows scaled;              ///< D⁻¹ times the panel at work
    FloatRows sides;               ///< [joint][size]: right-hand sides of joints
    FloatRows unknowns;            ///< x [joint][size]; joints 0 … length of every stretch, the last being the next stretch's first
    FloatRows ends;                ///< x at stretches' beginnings, level by level [size]
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
        static constexpr int tangent = 0, lever = 6, sheave = 8, drift = 10, grip = 12, sticks = 13, count = 14;
    };
    /// Rows of a joint's point.
    struct Point {
        static constexpr int normal_x = 0, normal_y = 1, lever = 2, grip = 3, count = 4;
    };
    LaneRows present;                      ///< 1, or 0 where the lane idles: no contact grips there
    LaneRows frame, tips, joints, plates;  ///< t; [4 Tip]; [rear, front][points Point]; μN
    FloatRows coupling;                    ///< g W, triangle
    double step = 0.0;                     ///< g [s]
    LaneRows velocity;                     ///< v̂, or whatever slips are asked for [link_size]
    LaneRows acceleration;                 ///< -A⁻¹ Tᵀ λ [link_size]
    LaneRows predicted;                    ///< this link's part of ŵ
    LaneRows own, own_start;               ///< this link's part of a slip; of one where the step begins
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
