#pragma once
/// Friction of a step: every contact of the chain (ContactField), their friction as an operator on velocities (FrictionOperator), with the
/// kernels of one instruction set, and the passes over the contacts that solve for it (FrictionSweep).
///
/// Contacts are those of fixed coordinates and changing velocities, laid out component by component so that lanes can run over links:
/// [component][column], column = link + FrictionRange::shift; the columns beside a range repeat the frames of the links beside it, the one
/// behind it also their joint. For pin halves only. Velocities inside a step are floats. They count from those at which the contacts were
/// recorded, so that small differences of large velocities are taken in double precision, once a step; a field also holds how contacts
/// slide at those.
///
/// Friction is solved for by implicit sweeps over its contacts. That of a step is of the velocities at ϑ of it,
///
///     v = v_0 + ϑ h (G + A⁻¹ Σ Jᵀ P),   P = -c s(|u|) u/|u|,   u = J v,   c = μN,   at the end v_0 + (v - v_0)/ϑ,
///
/// with each contact's force P found from the velocities that all others leave it: u = u* + r (P - P before), r its response. Joint points
/// are solved one after the other, joints of different pins at once, and so are links with their plates and tips. Forces are kept from step
/// to step as shares of c, and the next step begins with them and half of their last change.

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "model/basis/columns.hpp"
#include "model/chain/chain_model.hpp"
#include "model/machine/held_links.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

/// Numbers of the components of a contact field.
struct ContactComponents {
    int joint_points;  ///< integration points of a joint
    int plates;        ///< plates of a link

    /// Frame of the link: t_x, t_y, 1/|d0|; and |d0| θ'².
    static constexpr int frame_x = 0, frame_y = 1, inverse_length = 2, outward = 3;
    /// Components of a joint point; the joint is that of the link's rear pin.
    struct Joint {
        static constexpr int normal_x = 0, normal_y = 1, lever_before = 2, lever_after = 3, friction_limit = 4, count = 5;
    };
    /// Components of a tip; sheave: velocity of the sheave against the tip where it touches; drift: change of the sheave's over the step,
    /// along with the tip.
    struct Tip {
        static constexpr int normal = 0, lever_x = 3, lever_y = 4, sheave = 5, drift = 8, friction_limit = 11, count = 12;
    };
    [[nodiscard]] constexpr int joint(int point) const noexcept { return 4 + Joint::count * point; }
    /// μN of a plate [N].
    [[nodiscard]] constexpr int plate(int number) const noexcept { return joint(joint_points) + number; }
    [[nodiscard]] constexpr int tip(int corner) const noexcept { return plate(plates) + Tip::count * corner; }
    /// Sliding of a joint's points across the axis, z and e of the joint's gap and of the gap between the link's pins, all at the
    /// velocities that others count from [m/s].
    [[nodiscard]] constexpr int sliding(int point) const noexcept { return tip(tips_per_link) + point; }
    [[nodiscard]] constexpr int joint_gap() const noexcept { return sliding(joint_points); }
    [[nodiscard]] constexpr int plate_gap() const noexcept { return joint_gap() + 2; }
    [[nodiscard]] constexpr int count() const noexcept { return plate_gap() + 2; }
};

struct ContactField {
    explicit ContactField(const ChainModel& chain);
    /// Makes `count` columns.
    void make_columns(int count);

    [[nodiscard]] std::size_t bytes() const noexcept { return columns.bytes() + arms.bytes(); }

    ContactComponents components;
    FloatColumns columns;
    Columns arms;  ///< [3 tips_per_link] rows: from a sheave's origin to the contact point of each tip, x, y, z, of links that touch [m]
};

/// Links whose friction is found, with their velocities.
struct FrictionRange {
    int first, last;        ///< links [first, last)
    const float* velocity;  ///< [link_size()][stride] of links first - 1 … last
    std::ptrdiff_t stride;  ///< stride of `velocity`
    float* scratch;         ///< FrictionOperator::scratch_size(last - first) [m/s, N]
    const Phase* phases;    ///< [links * 4], of the whole chain
    double time;            ///< instant of the velocities, from the middle of the step, in steps [1]
    int shift = 1;          ///< column of a link in all fields but velocity: its number + shift
};

/// Mean friction of the tips over a step, as the sheaves feel it. Everything begins at the first link.
struct TipReactions {
    const float* forces;  ///< forces on the tips: [3 tips_per_link][stride] x, y, z of each [N]
    std::ptrdiff_t stride;
    const double* arms;  ///< ContactField::arms, [3 tips_per_link][arms_stride] [m]
    std::ptrdiff_t arms_stride;
    const Phase* phases;     ///< [4 links]
    const LinkLoad* normal;  ///< [links] by the normal forces
    LinkLoad* loads;         ///< [links] out, by both, where a tip touches
};

/// The step in whose middle a field is recorded.
struct ContactDrift {
    double step = 0.0;      ///< h [s]
    double change[4][6]{};  ///< changes of the sheaves' velocities over the step: vx, vy, vz, spins
};

/// Search in a record for the tips that touch: those that penetrate, and those that touched and have not receded by more than `release`.
struct TipSearch {
    Phase* phases;                         ///< [links * 4], of the whole chain; in and out
    double release;                        ///< PhaseRule::release [m]
    double deepest, innermost, outermost;  ///< limits of depths, and of the radii of links and of those that touch [m]
    bool suspect = false;                  ///< some link may be beyond a limit; out
};

/// Output of the pass over links that records contacts.
struct ContactRecord {
    const double* states;  ///< [unknowns] at the step's beginning, of the range's first link on
    ContactField& field;
    FloatColumns& frictionless;  ///< accelerations by everything but friction [m/s², rad/s²]
    FloatColumns& velocity;      ///< velocities at the step's beginning, counted from those at which contacts are recorded [m/s, rad/s]
};

/// Links at the end of a leapfrog's step, by the velocities that friction has left. Everything begins at the first link, and blocks [q | v]
/// of links follow one another.
struct StepEnd {
    const float* velocity;       ///< velocities at the end: [link_size()][stride]
    std::ptrdiff_t stride;       ///< stride of `velocity`
    const double* counted_from;  ///< blocks; velocities count from theirs
    const double* start;         ///< blocks at the step's start
    double* end;                 ///< blocks at its end: coordinates by the mean of the velocities at both
    double* secants;             ///< blocks of slopes: velocities at the end, mean accelerations
    double step;                 ///< [s]
    double limit;                ///< bound of every number of a sound state [m, m/s]
};

/// Constants of friction as floats, in which velocities inside a step are computed.
struct FrictionNumbers {
    FrictionNumbers(const Coefficients& coefficients, const HeldInverse& responses);

    std::shared_ptr<const TipLaw> tip_law;  ///< nullptr: none
    PointLanes<max_joint_lanes, float> joint_points;
    PointLanes<max_plate_lanes, float> plates;
    HeldNumbers<float> inverse;

    [[nodiscard]] bool filter_waves() const noexcept { return inverse.wave_joint[0] > 0.0F; }
};

class FrictionOperator;

struct FrictionSweep;
struct FrictionPowers;

/// Advances links: to = from + by · along, of the state of `links` links.
using LinkAdvance = void(const double* from, const double* along, double by, double* to, int links) noexcept;

/// Functions of friction, and of a step's middle and end, of one instruction set.
struct FrictionKernels {
    void (*record)(const FrictionOperator&, const ChainRange&, const ContactDrift&, const ContactRecord&, LinkLoad*, TipSearch*) noexcept;
    void (*sweep)(const FrictionOperator&, const ContactField&, const FrictionRange&, const FrictionSweep&) noexcept;
    /// Powers of the kept forces at the range's velocities. powers [links of the range]
    void (*powers)(const FrictionOperator&, const ContactField&, const FrictionRange&, const FloatColumns& kept,
                   FrictionPowers* powers) noexcept;
    /// @return whether the state of all links at the end is sound
    bool (*end)(const StepEnd&, int links) noexcept;
    LinkAdvance* advance;
    /// @param links neighbouring ones that are to have the mean friction of the tips in their loads
    void (*react)(const TipReactions&, int links) noexcept;
};

/// Friction as a function of velocities, for fields that record() has written. Velocities, forces and slopes of links are
/// [link_size()][stride] columns that begin at a range's first link - 1.
class FrictionOperator {
public:
    /// make_friction() (model/variator/variator.hpp) makes one with the kernels of the chain's instruction set.
    FrictionOperator(const ChainModel& chain, const FrictionKernels& kernels);

    /// Number of scratch numbers for a range of `links` links: rows of the forces of its joints (JointContacts).
    [[nodiscard]] int scratch_size(int links) const noexcept { return scratch_rows(chain_.layout().lateral()) * joint_stride(links); }
    [[nodiscard]] static constexpr int scratch_rows(int lateral) noexcept { return 2 * lateral + 4; }

    /// Columns of a row of scratch.
    [[nodiscard]] static constexpr int joint_stride(int links) noexcept {
        constexpr int line = FloatColumns::line;
        return (links + line) / line * line + line;
    }

    /// Records the contacts of a range of links, in one pass: the reactions on the sheaves become those of the normal forces alone. Writes
    /// the accelerations without friction, and the velocities at the step's beginning, to rows of the record's columns, column = link +
    /// range.shift. The frames of one link on each side of the range are recorded, too, and the joint of that behind it.
    /// @param loads of the range's first link on   @param search nullptr: tips touch as the range's phases state
    void record(const ChainRange& range, const ContactDrift& drift, const ContactRecord& to, LinkLoad* loads,
                TipSearch* search = nullptr) const noexcept {
        kernels_.record(*this, range, drift, to, loads, search);
    }
    [[nodiscard]] const FrictionKernels& kernels() const noexcept { return kernels_; }

    /// Holds links from now on, as a step of this length does: what record() gives, and how velocities respond to forces.
    /// @param step rounded, so that the rounding of times renews nothing [s]
    void hold(float step) noexcept;

    [[nodiscard]] const ChainModel& chain() const noexcept { return chain_; }
    /// Inverse by which velocities respond to forces.
    [[nodiscard]] const HeldInverse& inverse() const noexcept { return inverse_; }
    [[nodiscard]] const FrictionNumbers& numbers() const noexcept { return numbers_; }

private:
    const ChainModel& chain_;
    HeldInverse inverse_;
    float held_for_ = 0.0F;  ///< step that inverse_ holds links for; 0: none is held [s]
    FrictionNumbers numbers_;
    FrictionKernels kernels_;
};

/// Rows of what sweeps keep of a link from step to step; its joint is that of its rear pin.
struct SweepRows {
    /// Rows of a link that its waves move: x and y of both halves.
    static constexpr int wave_rows = 4 * axis_terms;
    int joint_points;  ///< integration points of a joint

    /// Share of a point's force across the axis, and along it in the next row [1].
    [[nodiscard]] static constexpr int joint(int point) noexcept { return 2 * point; }
    /// Friction of all plates: along z, and its moment in the next row [N].
    [[nodiscard]] constexpr int plates() const noexcept { return joint(joint_points); }
    /// Share of a tip's force: along the link, across it, along z [1].
    [[nodiscard]] constexpr int tip(int corner) const noexcept { return plates() + 2 + 3 * corner; }
    /// Rows so far.
    [[nodiscard]] constexpr int forces() const noexcept { return tip(tips_per_link); }
    /// Row with which the next step begins instead of a row of the forces.
    [[nodiscard]] constexpr int opening(int row) const noexcept { return forces() + row; }
    /// Speed at which the tangent of a joint point's equation was taken last [m/s].
    [[nodiscard]] constexpr int joint_speed(int point) const noexcept { return 2 * forces() + point; }
    /// Sliding of the plates by which their secants were taken last: z, and e in the next row [m/s].
    [[nodiscard]] constexpr int plate_rate() const noexcept { return joint_speed(joint_points); }
    /// Low pass of the accelerations by friction, of row x or y of the link [m/s²].
    [[nodiscard]] constexpr int lasting(int row) const noexcept { return plate_rate() + 2 + row; }
    [[nodiscard]] constexpr int count() const noexcept { return lasting(wave_rows); }
};

/// Share of the new value in the low pass: with three sweeps 0.1 feeds waves of one of twelve machines, 0.3 of three [1].
inline constexpr double lasting_share = 0.03;

/// ϑ: instant at which friction is solved, in steps from the step's beginning; 1 is backward Euler, 1/2 damps no error of a sweep [1].
inline constexpr double sweep_time = 0.75;

/// Responses of a contact's sliding to forces over ϑ h.
struct SweepResponses {
    /// @param step h [s]   @param nominal what a step takes that nothing cuts short: contacts respond as if this were its length [s]
    SweepResponses(const FrictionOperator& friction, double step, double nominal) noexcept;

    float step;                                                                  ///< ϑ h [s]
    std::array<float, max_joint_lanes> joint_across{}, joint_along{};            ///< response of a point to its force [m/s per N]
    std::array<std::array<float, axis_terms>, max_joint_lanes> joint_lateral{};  ///< response of a joint's modes to the force at a point
    float joint_shift;                                                           ///< response of its z to an axial force
    std::array<float, max_joint_lanes> joint_tilt{};                             ///< response of its e to the axial force at a point
    float tip;                      ///< response of a tip to equal forces at all tips of its link
    float plate_shift, plate_tilt;  ///< responses of the plates' z and e to their force and moment
    float link_shift, link_tilt;    ///< responses of either end's z and e to the plates' force and moment, over ϑ of the present step
    double of_step, of_nominal;     ///< arguments that they were made from [s]
};

/// Part of a step.
enum class SweepPart {
    opening,  ///< velocities with the forces of the step before, half their last change added; then plates and tips of the links
    middle,   ///< joints, then links
    closing,  ///< joints; then the velocities
};

/// One pass over joints and links. Columns over links (column = link + range.shift), all of the same shape.
struct FrictionSweep {
    SweepPart part;
    float ahead;  ///< share of the forces' last change with which the next step begins [1]
    const SweepResponses* responses;
    FloatColumns* base;             ///< accelerations by everything but friction; in: with those that last, unfiltered
    const FloatColumns* start;      ///< velocities at the step's start
    const FloatColumns* before;     ///< [SweepRows::count()] rows, as the step before has left them
    FloatColumns* kept;             ///< the same of this step
    FloatColumns* velocity;         ///< velocities at ϑ so far, those of the range
    FloatColumns* result;           ///< velocities at the end
    FloatColumns* mean_tip_forces;  ///< [3 tips_per_link] rows: mean force on each tip, x, y, z [N]
};

/// Power that friction takes from a link, with the joint of its rear pin, by kind [W].
struct FrictionPowers {
    double joint, plates, tips;
};

}  // namespace cvtflow::model
