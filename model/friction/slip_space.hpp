#pragma once
/// Implicit friction as a convex problem in slips. With contacts frozen (ContactField) and velocities v̂ before friction acts, a stage of an
/// implicit method solves
///
///     A (v - v̂) + g Σ Tᵀ φ(T v - s) = 0        g = γ h;  T v - s: slip of a contact, two components;  φ: its friction force
///
/// which is the minimum of ½ (v-v̂)ᵀ A (v-v̂) + g Σ Φ(T v - s). In slips w and forces λ = φ(w), with W = T A⁻¹ Tᵀ:   w = ŵ - g W λ.
/// W couples the contacts of a link, and the joints at its two ends. Newton: λ = K w + c with K = φ'(w) = R Rᵀ, c = φ(w) - K w; contacts of
/// plates and tips are eliminated inside their link, lanes over links; what is left are joints, λ = R x + c, one block x of 2 numbers
/// per integration point:
///
///     (1 + g Rᵀ W' R) x = Rᵀ (ŵ' - g W' c)      cyclic block-tridiagonal, symmetric, all eigenvalues ≥ 1
///
/// (W', ŵ': with plates and tips eliminated). Groups of links are condensed to the two joints at their ends side by side, then the ring of
/// these joints is solved, then everything is substituted back.

#include <span>
#include <vector>

#include "model/friction/contact_field.hpp"

namespace cvtflow::model {

/// Links of a group, side by side in lanes.
inline constexpr int slip_lanes = 8;

/// Rows of slip_lanes numbers each, one lane per link, on cache lines of their own.
class LaneRows {
public:
    LaneRows() = default;
    explicit LaneRows(int rows) : columns_(1, rows * slip_lanes) {}
    LaneRows(LaneRows&&) noexcept = default;
    LaneRows& operator=(LaneRows&&) noexcept = default;
    [[nodiscard]] double* at(int row) noexcept { return columns_.at(0, row * slip_lanes); }
    [[nodiscard]] const double* at(int row) const noexcept { return columns_.at(0, row * slip_lanes); }

private:
    Columns columns_;
};

/// Numbers of a link's contacts. A contact has two slips, rows 2k and 2k + 1: plates as one (gaps z' and e'), tips (two tangents of the
/// sheave), then points of the rear joint, then of the front joint (across, axial).
struct SlipContacts {
    int points;   ///< integration points of a joint
    static constexpr int plates = 0, first_tip = 1, first_joint = 5;

    [[nodiscard]] constexpr int count() const noexcept { return first_joint + 2 * points; }
    [[nodiscard]] constexpr int slips() const noexcept { return 2 * count(); }
    [[nodiscard]] constexpr int joint(End end, int point) const noexcept { return first_joint + (end == End::rear ? 0 : points) + point; }
    /// Slips of one joint.
    [[nodiscard]] constexpr int joint_slips() const noexcept { return 2 * points; }
    static constexpr int local_slips = 2 * first_joint;   ///< those of plates and tips come first
};
/// Entry (row, column ≤ row) of a lower triangle stored row by row.
[[nodiscard]] constexpr int triangle(int row, int column) noexcept { return row * (row + 1) / 2 + column; }

/// What two neighbouring joints have of each other: rows of the first joint, then of the second, each [on first | on second] with the
/// right-hand side behind the first block.
struct SlipElement {
    /// Numbers from the beginning of a block to the next: whole vectors, with room for the right-hand side.
    [[nodiscard]] static constexpr int block(int size) noexcept { return (size + slip_lanes) / slip_lanes * slip_lanes; }
    explicit SlipElement(int size) : width(2 * block(size)), entries(static_cast<std::size_t>(2 * size * width), 0.0) {}

    int width;
    std::vector<double> entries;
    [[nodiscard]] double* row(int number) noexcept { return entries.data() + number * width; }
    [[nodiscard]] const double* row(int number) const noexcept { return entries.data() + number * width; }
};

/// Joints in a row between two others, to which they are condensed. Element k joins joints k and k + 1; joints 1 … elements - 1 are eliminated.
struct SlipChain {
    SlipChain(int most_elements, int size);
    int size;                        ///< unknowns of a joint
    std::vector<SlipElement> elements;
    SlipElement condensed;           ///< first end, second end
    std::vector<double> panels;      ///< [joint][size][width]: matrix⁻¹ [on first end, right-hand side | on next]
    std::vector<double> solution;    ///< [joint][block], zeros behind the joint's unknowns

    [[nodiscard]] double* unknowns(int joint) noexcept { return solution.data() + joint * SlipElement::block(size); }
    [[nodiscard]] const double* unknowns(int joint) const noexcept { return solution.data() + joint * SlipElement::block(size); }
};

/// Contacts and unknowns of a group of links.
struct SlipGroup {
    SlipGroup(const ChainModel& chain, int first_link, int last_link);

    int first, last;                        ///< links [first, last)
    bool touching = false;                  ///< some tip touches
    /// Rows of a tip: tangents, their levers/|d0|, the sheave's velocity along them and its change over the step, μN, 1 where it must stick.
    struct Tip {
        static constexpr int tangent = 0, lever = 6, sheave = 8, drift = 10, grip = 12, sticks = 13, count = 14;
    };
    /// Rows of a joint's point.
    struct Point {
        static constexpr int normal_x = 0, normal_y = 1, lever = 2, grip = 3, count = 4;
    };
    LaneRows frame, tips, joints, plates;   ///< t; [4 Tip]; [rear, front][points Point]; μN
    LaneRows coupling;                      ///< g W, triangle
    LaneRows velocity;                      ///< v̂, or whatever slips are asked for [link_size]
    LaneRows acceleration;                  ///< -A⁻¹ Tᵀ λ [link_size]
    LaneRows predicted;                     ///< this link's part of ŵ
    LaneRows own, own_start;                ///< this link's part of a slip; of one where the step begins
    LaneRows slip, force, law_force;        ///< w, λ at hand, φ(w)
    LaneRows next_slip, next_force;         ///< of a whole Newton step
    LaneRows solved_slip;                   ///< w of the last solution with higher saturation speeds
    LaneRows root, intercept;               ///< R [contact][4], c
    LaneRows factor, rest, panel;           ///< elimination inside a link: L, L⁻¹ Rᵀ t, L⁻¹ Rᵀ g W
    LaneRows joint_coupling, joint_rest;    ///< g W' and its right-hand side
    LaneRows entries;                       ///< of the chain's elements [row][column], zero where nothing belongs
    LaneRows unknowns;                      ///< x of both joints
    SlipChain chain;
    double widening = 1.0;                  ///< saturation speeds are taken so many times as high
    double slope_before = 0.0, slope_after = 0.0;   ///< of the energy along the Newton step, at its start and where it was looked at
    double residual = 0.0;                  ///< largest change of slip that a contact's force is off [m/s]
};

class SlipSpace;

/// Functions of one order, number of points and instruction set.
struct SlipKernels {
    using OnGroup = void (*)(const SlipSpace&, SlipGroup&) noexcept;
    void (*gather)(const SlipSpace&, const ContactField&, const Phase*, double g, SlipGroup&) noexcept;
    void (*slips)(const SlipSpace&, double time, SlipGroup&, LaneRows&) noexcept;
    OnGroup forces, accelerate, eliminate, substitute;
    void (*look)(const SlipSpace&, double share, SlipGroup&) noexcept;
    void (*ring)(SlipChain&) noexcept;
};

/// Constants of slips and forces for one chain, and the kernels that work on groups. @param chain must outlive this
class SlipSpace {
public:
    SlipSpace(const ChainModel& chain, bool by_phase);

    /// Takes the contacts of a group's links from a field, and makes g W. @param phases of the whole chain
    void gather(const ContactField& field, const Phase* phases, double g, SlipGroup& group) const noexcept { kernels_.gather(*this, field, phases, g, group); }
    /// Each link's part of the slips at group.velocity, into `own`. @param time of the velocities, from the middle of the step, in steps
    void slips(double time, SlipGroup& group, LaneRows& own) const noexcept { kernels_.slips(*this, time, group, own); }
    /// λ = φ(w) at group.slip.
    void forces(SlipGroup& group) const noexcept { kernels_.forces(*this, group); }
    /// Accelerations by group.force.
    void accelerate(SlipGroup& group) const noexcept { kernels_.accelerate(*this, group); }
    /// Newton's matrix at group.slip, condensed to the joints at the group's ends.
    void eliminate(SlipGroup& group) const noexcept { kernels_.eliminate(*this, group); }
    /// Solves the ring of the groups' condensed elements; joints 0 and elements are the same.
    void solve(SlipChain& ring) const noexcept { kernels_.ring(ring); }
    /// next_force, next_slip of plates and tips, and `own` parts of the joints' slips, from the ends' unknowns in group.chain.solution.
    void substitute(SlipGroup& group) const noexcept { kernels_.substitute(*this, group); }
    /// The energy's slope along the step, and what is left, at a share of it in [0, 1].
    void look(double share, SlipGroup& group) const noexcept { kernels_.look(*this, share, group); }

    [[nodiscard]] const ChainModel& chain() const noexcept { return friction_.chain(); }
    [[nodiscard]] const FrictionOperator& friction() const noexcept { return friction_; }
    [[nodiscard]] const SlipContacts& contacts() const noexcept { return contacts_; }
    [[nodiscard]] const FrictionCurve& tip_curve() const noexcept { return tip_curve_; }
    /// Directions in which contacts act on a link's x or y: ends of halves (corner/2, ±1), rear points, front points, turning; and on z and e:
    /// corners, rear points, front points, gap z, gap e.
    [[nodiscard]] int turning() const noexcept { return 4 + 2 * contacts_.points; }
    /// dᵀ A⁻¹ d' of two of them.
    [[nodiscard]] double lateral(int a, int b) const noexcept { return lateral_gram_[static_cast<std::size_t>(a * (turning() + 1) + b)]; }
    [[nodiscard]] double axial(int a, int b) const noexcept { return axial_gram_[static_cast<std::size_t>(a * (turning() + 2) + b)]; }

private:
    FrictionOperator friction_;
    SlipContacts contacts_;
    FrictionCurve tip_curve_;
    std::vector<double> lateral_gram_, axial_gram_;
    SlipKernels kernels_;
};

}  // namespace cvtflow::model
