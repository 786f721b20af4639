#pragma once
/// Every friction contact of the chain, for fixed coordinates and changing velocities, laid out component by component so that lanes can
/// run over links: [component][column], column = link + FrictionRange::shift; the columns beside a range repeat the frames of the links
/// beside it, the one behind it also their joint. For pin halves only.
///
/// Velocities inside a step are floats. They count from those at which the contacts were recorded, so that small differences of large
/// velocities are taken in double precision, once a step; a field also holds how contacts slide at those.

#include <cstddef>
#include <vector>

#include "model/basis/columns.hpp"
#include "model/chain/chain_model.hpp"
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

}  // namespace cvtflow::model
