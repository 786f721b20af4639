#pragma once
/// Rows of one link in the exact Jacobian: the elements of model/force over numbers with derivatives, and their contributions.

#include <cstring>

#include "bench/method/jacobian/dual_lanes.hpp"
#include "bench/method/jacobian/jacobian.hpp"
#include "bench/method/product_names.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/link_frame.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/machine/link_inertia.hpp"

namespace cvtflow::bench {

namespace {

// The elements of model/force at one point - a plate, a point of a joint, a tip - over numbers with derivatives. Each depends on fewer
// numbers than the axes have coordinates.

/// A plate depends on a difference without tilt and bending: x, y, z and their rates.
inline constexpr int six = directions<6>;
/// A point of a joint depends on x, y, three rates, and direction and turning of both links, three each.
inline constexpr int eleven = directions<11>;
/// A tip depends on the axis as a line: five of the half, the link's direction, five rates, the turning, the sheave's motion.
inline constexpr int two_dozen = directions<24>;

/// A point seen alone: of a difference it has x_0, y_0 and z.
template <int W>
struct LonePoint {
    double xi = 0.0;

    [[nodiscard]] static Lanes<W> along(const Lanes<W>* c) noexcept { return c[0]; }
    /// @param terms [2 axis_terms + 2]
    static void spread(const Lanes<W>& fx, const Lanes<W>& fy, const Lanes<W>& fz, Lanes<W>* terms) noexcept {
        std::fill_n(terms, 2 * axis_terms + 2, Lanes<W>(0.0));
        terms[place_of(0)] = fx;
        terms[place_of(1)] = fy;
        terms[place_of(2)] = fz;
    }
    /// Place of component 0 x, 1 y, 2 z among the terms.
    [[nodiscard]] static constexpr std::size_t place_of(int component) noexcept { return static_cast<std::size_t>(component * axis_terms); }
};

/// Force of one plate on the front half. d, rate: distances and velocities along x, y, z
[[nodiscard, gnu::noinline]] inline std::array<Lanes<six>, 3> plate_at(const Coefficients& c, const LinkKind& kind, const LinkFrame& frame,
                                                                       int plate, const Lanes<six> (&d)[3],
                                                                       const Lanes<six> (&rate)[3]) noexcept {
    const auto j = static_cast<std::size_t>(plate);
    const auto turned = [&](const Lanes<six>(&of)[3]) {
        return PlateVector<Lanes<six>>{of[0] * frame.tx + of[1] * frame.ty, of[1] * frame.tx - of[0] * frame.ty, of[2]};
    };
    PlateVector<Lanes<six>> place = turned(d);
    const PlateVector<Lanes<six>> moving = turned(rate);
    place.along = place.along - kind.free_length;
    const auto stretch = plate_stretch<six>(Lanes<six>(kind.free_length), c.plates.weight[j], c.plates.damping[j], place, moving);
    const auto force = plate_force<six>(stretch, place, moving.z, plate_slide<six>(c, stretch, moving.z));
    return {force.along * frame.tx - force.across * frame.ty, force.along * frame.ty + force.across * frame.tx, force.z};
}

using PointOfJoint = JointTerms<eleven>;

/// One point of a joint, in the order of JointForce.
[[nodiscard, gnu::noinline]] inline PointOfJoint joint_at(const Coefficients& c, const JointPlace<Lanes<eleven>>& place,
                                                          int point) noexcept {
    const LonePoint<eleven> alone;
    const Lanes<eleven> weight(c.joint_points.weight[static_cast<std::size_t>(point)]);
    const auto motion = joint_motion<eleven>(c.joint, place, alone);
    NoBooks none;
    const auto friction = [&](const Lanes<eleven>& normal) { return rolling_friction<eleven>(c.joint, motion, normal, none); };
    PointOfJoint terms = rolling_contact_force<eleven>(c.joint, place.frames, alone, weight, motion, none, friction);
    if (all_at_most<eleven>(beyond_clearance<eleven>(c.joint, place.frames, motion), 0.0)) return terms;
    const PointOfJoint held = clearance_force<eleven>(c.joint, place.frames, alone, weight, motion, none);
    for (std::size_t k = 0; k < terms.size(); ++k) terms[k] += held[k];
    return terms;
}

/// Effect of a tip on its link and on its sheave.
struct TipEffect {
    TipAction<Lanes<two_dozen>> action{};
    TipReaction<Lanes<two_dozen>> reaction{};
};

/// Effect of a tip on one side, none where it has a gap. q, v: of a link whose rear half is the tip's
template <int side>
[[nodiscard, gnu::noinline]] inline TipEffect tip_at(const Coefficients& c, const LinkFrameOf<Lanes<two_dozen>>& frame,
                                                     const Lanes<two_dozen>* q, const Lanes<two_dozen>* v,
                                                     const SheaveLanes<Lanes<two_dozen>>& sheave, Phase phase) noexcept {
    const OneTip<two_dozen, End::rear, side> tip;
    const auto geometry = tip_geometry(c, tip, frame, q, sheave);
    if (!(geometry.depth.value > 0.0)) return {};
    const auto motion = tip_motion(c, tip, frame, v, sheave, geometry);
    const PhaseLanes phases{&phase, 0, phase == Phase::stick || phase == Phase::slip, 1};
    NoBooks none;
    const auto forces = tip_forces<two_dozen>(c.tip, geometry, motion, Lanes<two_dozen>(1.0), phases, none);
    return {tip_action(c, frame, geometry, motion, forces), tip_reaction(geometry, motion, forces)};
}

// Derivatives of one link's generalized forces with respect to its unknowns, those of its two neighbours, and the motion of its sheaves:
// rows of forces and one of the moment about z, filled contribution by contribution.

/// Frame of a link, differentiated in (dx, dy, vx, vy), the difference of its halves and its rate.
using DualFrame = LinkFrameOf<Dual<4>>;

class LinkRows {
public:
    static constexpr int size = link_layout.link_size();
    static constexpr int sheaves_at = 6 * size;
    static constexpr int width = 6 * size + 2 * sheave_directions;

    /// Column of an unknown. @param link 0 before, 1 itself, 2 after
    [[nodiscard]] static constexpr int column(int link, With with, int coordinate) noexcept {
        return (2 * link + static_cast<int>(with)) * size + coordinate;
    }
    [[nodiscard]] static constexpr int sheave_column(int side, int direction) noexcept {
        return sheaves_at + side * sheave_directions + direction;
    }

    [[nodiscard]] double* row(int coordinate) noexcept { return rows_[coordinate]; }
    [[nodiscard]] double* moment_row() noexcept { return rows_[size]; }
    double moment = 0.0;  ///< value of the moment [N·m]

    /// row += g_tx ∂tx + g_ty ∂ty + g_w ∂θ' with respect to the coordinates and velocities of a link with this frame. row [width]
    static void add_frame(double* row, int link, const DualFrame& frame, double g_tx, double g_ty, double g_turning) noexcept {
        for (std::size_t d = 0; d < 4; ++d)
            add_difference(row, link, static_cast<int>(d),
                           g_tx * frame.tx.slope[d] + g_ty * frame.ty.slope[d] + g_turning * frame.turning.slope[d]);
    }

    /// The moment as a couple on the m = 0 coordinates; after all contributions.
    void fold_moment(const DualFrame& frame) noexcept {
        const Dual<4> cx = -(frame.inverse_length * frame.ty), cy = frame.inverse_length * frame.tx;
        add_couple(link_layout.x(End::front, 0), 1.0, cx);
        add_couple(link_layout.y(End::front, 0), 1.0, cy);
        add_couple(link_layout.x(End::rear, 0), -1.0, cx);
        add_couple(link_layout.y(End::rear, 0), -1.0, cy);
    }

    /// Forces to accelerations.
    void accelerate(const LinkInertia& inertia) noexcept {
        constexpr int lateral = 2 * axis_terms;
        solve<lateral>(inertia.lateral, 0);
        solve<lateral>(inertia.lateral, lateral);
        solve<4>(inertia.axial, 2 * lateral);
    }

private:
    /// row [width]
    static void add_difference(double* row, int link, int direction, double value) noexcept {
        const With with = direction < 2 ? With::position : With::velocity;
        const bool x = direction % 2 == 0;
        row[column(link, with, x ? link_layout.x(End::front, 0) : link_layout.y(End::front, 0))] += value;
        row[column(link, with, x ? link_layout.x(End::rear, 0) : link_layout.y(End::rear, 0))] -= value;
    }
    /// sign [1]
    void add_couple(int coordinate, double sign, const Dual<4>& arm) noexcept {
        double* out = rows_[coordinate];
        for (int k = 0; k < width; ++k) out[k] += sign * arm.value * rows_[size][k];
        for (int d = 0; d < 4; ++d) add_difference(out, 1, d, sign * moment * arm.slope[static_cast<std::size_t>(d)]);
    }
    /// N rows by their products with an inverse.
    template <int N>
    void solve(const SmallInverse& inverse, int first) noexcept {
        double products[N][width] = {};
        for (int k = 0; k < N; ++k) {
            for (int r = 0; r < N; ++r) {
                const double factor = inverse.column[static_cast<std::size_t>(k * padded(N) + r)];
                for (int c = 0; c < width; ++c) products[r][c] += factor * rows_[first + k][c];
            }
        }
        std::memcpy(rows_[first], products, sizeof products);
    }

    double rows_[size + 1][width] = {};  ///< [force or moment][unknown]
};

// Contributions of joints to the rows of a link: the element of model/force, over numbers with derivatives.

/// Elasticity inside the link, in all of its unknowns at once. state [unknowns of the link]
inline void add_inner(const Coefficients& c, const LinkKind& kind, const double* state, LinkRows& rows) noexcept {
    constexpr int n = LinkRows::size;
    using T = Dual<2 * n>;
    T q[n], v[n], f[n];
    for (int k = 0; k < n; ++k) {
        q[k] = T::variable(state[k], k);
        v[k] = T::variable(state[n + k], n + k);
    }
    NoBooks none;
    const T moment = inner_elasticity(c, kind, link_frame(q, v), q, v, f, none);
    const auto add = [](const T& from, double* row) {
        for (int k = 0; k < 2 * n; ++k) row[LinkRows::column(1, With::position, 0) + k] += from.slope[static_cast<std::size_t>(k)];
    };
    for (int k = 0; k < n; ++k) add(f[k], rows.row(k));
    add(moment, rows.moment_row());
    rows.moment += moment.value;
}

/// Σ c_m P_m(ξ) with the values of one lane. c [coefficients of the axis]
template <int Most>
[[nodiscard]] inline double along_axis(const PointLanes<Most>& points, std::size_t lane, const double* c) noexcept {
    double value = c[0];
    for (std::size_t m = 1; m < axis_terms; ++m) value += c[m] * points.basis[m][lane];
    return value;
}

/// How a force at a point of the axis spreads over a difference of halves, (x_0 … x_P, y_0 … y_P, z, e), and vice versa.
struct PointWeights {
    static constexpr int count = 2 * axis_terms + 2;
    double x[axis_terms];  ///< P_m(ξ) [1]
    double xi;             ///< ξ [1]

    template <class Points>
    PointWeights(const Points& points, std::size_t lane) noexcept : xi(points.position[lane]) {
        x[0] = 1.0;
        for (std::size_t m = 1; m < axis_terms; ++m) x[m] = points.basis[m][lane];
    }
    /// Weight of a coordinate of the difference, and the component of the point that it moves (0 x, 1 y, 2 z).
    [[nodiscard]] double weight(int coordinate) const noexcept {
        if (coordinate < 2 * axis_terms) return x[coordinate % axis_terms];
        return coordinate == 2 * axis_terms ? 1.0 : xi;
    }
    [[nodiscard]] static int component(int coordinate) noexcept {
        return coordinate < axis_terms ? 0 : coordinate < 2 * axis_terms ? 1 : 2;
    }
    /// Place of the coordinate in a link's q.
    [[nodiscard]] static int place(int coordinate, End end) noexcept {
        if (coordinate < axis_terms) return link_layout.x(end, coordinate);
        if (coordinate < 2 * axis_terms) return link_layout.y(end, coordinate - axis_terms);
        return coordinate == 2 * axis_terms ? link_layout.z(end) : link_layout.e(end);
    }
};

/// state [unknowns of the link]
inline void add_plates(const Coefficients& c, const LinkKind& kind, const double* state, LinkRows& rows) noexcept {
    constexpr int n = LinkRows::size;
    using T = Lanes<six>;  // x y z | their rates
    using Weights = PointWeights;
    double local[Weights::count][2 * Weights::count] = {};
    const LinkFrame frame = link_frame(state, state + n);
    const Difference<> d(state, End::front, state, End::rear), rate(state + n, End::front, state + n, End::rear);
    for (std::size_t j = 0; j < static_cast<std::size_t>(c.plates.count); ++j) {
        const Weights weights(c.plates, j);
        const double xi = weights.xi;
        const T place[3] = {T::variable(along_axis(c.plates, j, d.x), 0), T::variable(along_axis(c.plates, j, d.y), 1),
                            T::variable(d.z + xi * d.e, 2)};
        const T moving[3] = {T::variable(along_axis(c.plates, j, rate.x), 3), T::variable(along_axis(c.plates, j, rate.y), 4),
                             T::variable(rate.z + xi * rate.e, 5)};
        const auto parts = plate_at(c, kind, frame, static_cast<int>(j), place, moving);
        for (int r = 0; r < Weights::count; ++r) {
            const T& part = parts[static_cast<std::size_t>(Weights::component(r))];
            for (int k = 0; k < 2 * Weights::count; ++k) {
                const int of = k % Weights::count, direction = Weights::component(of) + (k < Weights::count ? 0 : 3);
                local[r][k] += weights.weight(r) * weights.weight(of) * part.slope[static_cast<std::size_t>(direction)];
            }
        }
    }
    for (int r = 0; r < Weights::count; ++r) {
        for (int k = 0; k < 2 * Weights::count; ++k) {
            const With with = k < Weights::count ? With::position : With::velocity;
            const int of = k % Weights::count;
            const int front = LinkRows::column(1, with, Weights::place(of, End::front)),
                      rear = LinkRows::column(1, with, Weights::place(of, End::rear));
            double* ahead = rows.row(Weights::place(r, End::front));
            double* behind = rows.row(Weights::place(r, End::rear));
            ahead[front] += local[r][k];
            ahead[rear] -= local[r][k];
            behind[front] -= local[r][k];
            behind[rear] += local[r][k];
        }
    }
}

}  // namespace

namespace {

/// The two links of a joint and their places among the columns: `before` and `before` + 1.
struct JointLinks {
    const double* state_before;  ///< [unknowns of a link]
    const double* state_after;   ///< [unknowns of a link]
    const DualFrame& frame_before;
    const DualFrame& frame_after;
    int before;
};

/// Derivatives of one joint's effect on one of its links: a force on the half, and the moment.
class JointRows {
public:
    using Weights = PointWeights;
    using T = Lanes<eleven>;  // gx gy | ax ay az | direction and turning of the link before | of the link after
    static constexpr int gaps = 2 * axis_terms, rates = Weights::count, inputs = gaps + rates + 6;

    JointRows(const Coefficients& c, const JointLinks& links, bool of_after) noexcept : of_after_(of_after) {
        constexpr int n = link_layout.link_size();
        const Difference<> gap(links.state_before, End::front, links.state_after, End::rear);
        const Difference<> rate(links.state_before + n, End::front, links.state_after + n, End::rear);
        for (std::size_t g = 0; g < static_cast<std::size_t>(c.joint_points.count); ++g) {
            const Weights weights(c.joint_points, g);
            const auto& points = c.joint_points;
            const auto variable = [](double value, int direction) { return T::variable(value, direction); };
            const auto frame = [&](const DualFrame& of, int first) {
                return LinkFrameOf<T>{variable(of.tx.value, first), variable(of.ty.value, first + 1), 0.0,
                                      variable(of.turning.value, first + 2)};
            };
            Difference<T> open, opening;
            open.x[0] = variable(along_axis(points, g, gap.x), 0);
            open.y[0] = variable(along_axis(points, g, gap.y), 1);
            opening.x[0] = variable(along_axis(points, g, rate.x), 2);
            opening.y[0] = variable(along_axis(points, g, rate.y), 3);
            opening.z = variable(rate.z + weights.xi * rate.e, 4);
            const auto place = joint_place(c.joint, frame(links.frame_before, 5), frame(links.frame_after, 8), open, opening);
            add_point(weights, joint_at(c, place, static_cast<int>(g)));
        }
    }

    void add_to(const JointLinks& links, LinkRows& rows) const noexcept {
        const double sign = of_after_ ? -1.0 : 1.0;
        for (int r = 0; r < Weights::count; ++r)
            add_row(links, local_[r], sign, rows.row(Weights::place(r, of_after_ ? End::rear : End::front)));
        add_row(links, local_[Weights::count], 1.0, rows.moment_row());
        rows.moment += moment_;
    }

private:
    /// Derivatives of one component of a point, spread over the inputs. factor [1], out [inputs]
    static void spread(const Weights& weights, double factor, const T& part, double* out) noexcept {
        for (int k = 0; k < gaps; ++k) out[k] += factor * weights.weight(k) * part.slope[static_cast<std::size_t>(Weights::component(k))];
        for (int k = 0; k < rates; ++k)
            out[gaps + k] += factor * weights.weight(k) * part.slope[static_cast<std::size_t>(2 + Weights::component(k))];
        for (std::size_t k = 0; k < 6; ++k) out[gaps + rates + static_cast<int>(k)] += factor * part.slope[5 + k];
    }
    /// terms: force on the half in front, its moment along the axis (none at a point), moments on both links
    void add_point(const Weights& weights, const PointOfJoint& terms) noexcept {
        for (int r = 0; r < Weights::count; ++r)
            spread(weights, weights.weight(r), terms[LonePoint<eleven>::place_of(Weights::component(r))], local_[r]);
        const T& moment = terms[2 * axis_terms + (of_after_ ? 3 : 2)];
        spread(weights, 1.0, moment, local_[Weights::count]);
        moment_ += moment.value;
    }
    /// g [inputs], sign [1], row [LinkRows::width]
    static void add_row(const JointLinks& links, const double* g, double sign, double* row) noexcept {
        const auto add = [&](With with, int k, double value) {
            row[LinkRows::column(links.before, with, Weights::place(k, End::front))] += sign * value;
            row[LinkRows::column(links.before + 1, with, Weights::place(k, End::rear))] -= sign * value;
        };
        for (int k = 0; k < gaps; ++k) add(With::position, k, g[k]);
        for (int k = 0; k < rates; ++k) add(With::velocity, k, g[gaps + k]);
        const double* f = g + gaps + rates;
        LinkRows::add_frame(row, links.before, links.frame_before, sign * f[0], sign * f[1], sign * f[2]);
        LinkRows::add_frame(row, links.before + 1, links.frame_after, sign * f[3], sign * f[4], sign * f[5]);
    }

    bool of_after_;
    double moment_ = 0.0;                            ///< moment on the link [N·m]
    double local_[Weights::count + 1][inputs] = {};  ///< [force or moment][input]
};

// Contributions of tips to the rows of a link and of the pulleys: the element of model/force, over numbers with derivatives.

/// Motion of one tip by the link's unknowns, and its effect.
/// The axis of a pin half is a straight line for a tip, which depends on its coefficients c_0, c_1 along x and y, and z at
/// its end.
class TipRows {
public:
    using T = Lanes<two_dozen>;
    enum Direction { x0, x1, y0, y1, z, tx, ty, rate_x0, rate_x1, rate_y0, rate_y1, rate_z, turning, first_of_sheave };

    /// state [unknowns]
    TipRows(const Coefficients& c, const double* state, const DualFrame& frame, const SheaveMotion& sheave, End end, int side,
            Phase phase) noexcept
        : frame_(frame), end_(end), sign_(side == 0 ? -1.0 : 1.0), side_(side) {
        for (int m = 0; m < axis_terms; ++m) {
            const bool even = m % 2 == 0;
            value_[m] = even ? 1.0 : sign_;
            slope_[m] = 0.5 * m * (m + 1) * (even ? sign_ : 1.0);
            start_[m] = value_[m] - sign_ * slope_[m];
        }
        T q[link_layout.link_size()], v[link_layout.link_size()];
        straight(state, x0, q);
        straight(state + LinkRows::size, rate_x0, v);
        const LinkFrameOf<T> of_link{T::variable(frame.tx.value, tx), T::variable(frame.ty.value, ty), 0.0,
                                     T::variable(frame.turning.value, turning)};
        const auto tip = side == 0 ? tip_at<0> : tip_at<1>;
        effect_ = tip(c, of_link, q, v, moving(sheave), phase);
    }

    void add_to(LinkRows& rows) const noexcept {
        double link_row[LinkRows::width];
        const auto expanded = [&](const T& part) { expand(part, link_row); };
        for (const bool along_x : {true, false}) {
            const auto place = [&](int m) { return along_x ? link_layout.x(end_, m) : link_layout.y(end_, m); };
            expanded(along_x ? effect_.action.total.x : effect_.action.total.y);
            for (int m = 0; m < axis_terms; ++m) add(value_[m], link_row, rows.row(place(m)));
            expanded(along_x ? effect_.action.tilt_x : effect_.action.tilt_y);
            for (int m = 1; m < axis_terms; ++m) add(slope_[m], link_row, rows.row(place(m)));
        }
        expanded(effect_.action.total.z);
        add(1.0, link_row, rows.row(link_layout.z(end_)));
        add(sign_, link_row, rows.row(link_layout.e(end_)));
        expanded(effect_.action.moment);
        add(1.0, link_row, rows.moment_row());
        rows.moment += effect_.action.moment.value;
    }

    /// Adds rows of the pulleys on this link, and the effect of the sheave's motion on the sheave.
    void add_to_sheave(const ExactJacobian::SheaveMap& sheave, int link, AccelerationJacobian& out,
                       SheaveStiffness& stiffness) const noexcept {
        constexpr int n = LinkRows::size;
        const T* loads[6] = {&effect_.reaction.force.x,  &effect_.reaction.force.y, &effect_.reaction.moment.x,
                             &effect_.reaction.moment.y, &effect_.reaction.force.z, &effect_.reaction.moment.z};
        double link_row[LinkRows::width];
        for (std::size_t load = 0; load < 6; ++load) {
            expand(*loads[load], link_row);
            for (const auto& effect : sheave.effects[load]) {
                for (const With with : {With::position, With::velocity}) {
                    double* row = out.rows(link, with) + effect.coordinate * n;
                    for (int k = 0; k < n; ++k) row[k] += effect.factor * link_row[LinkRows::column(1, with, k)];
                }
            }
            for (std::size_t d = 0; d < sheave_directions; ++d) stiffness[load][d] += loads[load]->slope[first_of_sheave + d];
        }
    }

private:
    /// The half's coordinates or velocities as those of a straight one. from [coordinates of the link], first: direction of x0
    void straight(const double* from, int first, T* to) const noexcept {
        const auto sum = [](const double* x, const double* weights) {
            double total = 0.0;
            for (int m = 0; m < axis_terms; ++m) total += weights[m] * x[m];
            return total;
        };
        const double *along_x = from + link_layout.x(end_, 0), *along_y = from + link_layout.y(end_, 0);
        to[link_layout.x(End::rear, 0)] = T::variable(sum(along_x, start_), first + x0);
        to[link_layout.x(End::rear, 1)] = T::variable(sum(along_x, slope_), first + x1);
        to[link_layout.y(End::rear, 0)] = T::variable(sum(along_y, start_), first + y0);
        to[link_layout.y(End::rear, 1)] = T::variable(sum(along_y, slope_), first + y1);
        to[link_layout.z(End::rear)] = T::variable(from[link_layout.z(end_)] + sign_ * from[link_layout.e(end_)], first + z);
    }

    [[nodiscard]] static SheaveLanes<T> moving(const SheaveMotion& s) noexcept {
        const double values[sheave_directions] = {s.x, s.y, s.z, s.tilt_x, s.tilt_y, s.vx, s.vy, s.vz, s.spin_x, s.spin_y, s.spin_z};
        T d[sheave_directions];
        for (int k = 0; k < sheave_directions; ++k) d[k] = T::variable(values[k], first_of_sheave + k);
        return {{d[0], d[1], d[2]}, d[3], d[4], {d[5], d[6], d[7]}, {d[8], d[9], d[10]}};
    }

    /// Derivatives of one number with respect to the link's unknowns and its sheaves' motion.
    void expand(const T& part, double* out) const noexcept {
        using Rows = LinkRows;
        std::memset(out + Rows::column(1, With::position, 0), 0, 2 * Rows::size * sizeof(double));
        std::memset(out + Rows::sheaves_at, 0, 2 * sheave_directions * sizeof(double));
        const auto& g = part.slope;
        for (const With with : {With::position, With::velocity}) {
            const std::size_t first = with == With::position ? 0 : rate_x0;
            const auto to = [&](int coordinate) -> double& { return out[Rows::column(1, with, coordinate)]; };
            for (int m = 0; m < axis_terms; ++m) {
                to(link_layout.x(end_, m)) = start_[m] * g[first + x0] + slope_[m] * g[first + x1];
                to(link_layout.y(end_, m)) = start_[m] * g[first + y0] + slope_[m] * g[first + y1];
            }
            to(link_layout.z(end_)) = g[first + z];
            to(link_layout.e(end_)) = sign_ * g[first + z];
        }
        Rows::add_frame(out, 1, frame_, g[tx], g[ty], g[turning]);
        for (std::size_t d = 0; d < sheave_directions; ++d) out[Rows::sheave_column(side_, static_cast<int>(d))] = g[first_of_sheave + d];
    }
    static void add(double factor, const double* from, double* row) noexcept {
        using Rows = LinkRows;
        for (int k = Rows::column(1, With::position, 0); k < Rows::column(2, With::position, 0); ++k) row[k] += factor * from[k];
        for (int k = Rows::sheaves_at; k < Rows::width; ++k) row[k] += factor * from[k];
    }

    const DualFrame& frame_;
    End end_;
    double sign_;  ///< sign of the side
    int side_;
    double value_[axis_terms],
        slope_[axis_terms];     ///< weights of coordinates in the end of the axis, and in its slope over slope_scale [1]
    double start_[axis_terms];  ///< weights of coordinates in c_0 of the straight line [1]
    TipEffect effect_;
};

}  // namespace

}  // namespace cvtflow::bench
