#pragma once
/// Forces of one link, one joint and the tips of one link, and the accelerations of a link, with lanes over equal parts inside of it:
/// points of a joint, tips, bending modes. Formulas are those of LinkPass, whose lanes are links (model/kernels/link_pass.hpp), with sums
/// in the same trees, so results are bitwise equal.

#include <cmath>
#include <cstring>

#include "model/basis/lanes.hpp"
#include "model/chain/chain_model.hpp"
#include "model/force/inner.hpp"
#include "model/force/joint.hpp"
#include "model/force/plates.hpp"
#include "model/force/tips.hpp"
#include "model/machine/link_inertia.hpp"

namespace cvtflow::model {
namespace {

/// Books of one link: sums over lanes to an account.
struct SummingBooks {
    static constexpr bool observed = true;
    Account* account;

    void lose(Loss kind, double watts) const noexcept { account->lose(kind, watts); }
    void store(Energy kind, double joules, double factor = 1.0) const noexcept { account->store(kind, factor * joules); }
    template <int W>
    void lose(Loss kind, const Lanes<W>& watts) const noexcept {
        account->lose(kind, sum<W>(watts));
    }
    template <int W>
    void store(Energy kind, const Lanes<W>& joules, double factor = 1.0) const noexcept {
        account->store(kind, factor * sum<W>(joules));
    }
};

using TipLanes = Lanes<tips_per_link>;

/// The four tips of one link. Reals of the link are numbers, those of tips have four lanes.
struct FourTips {
    using Real = double;
    using Tips = TipLanes;
    static constexpr int width = tips_per_link;

    /// (-, +, -, +): numbers that differ between the two sides.
    [[nodiscard]] static Tips by_side(double minus, double plus) noexcept {
        const Lanes<2> sides = join<1>(minus, plus);
        return join<2>(sides, sides);
    }
    /// (rear, rear, front, front): numbers that differ between the two ends of the link.
    [[nodiscard]] static Tips by_end(double rear, double front) noexcept { return join<2>(Lanes<2>(rear), Lanes<2>(front)); }
};

/// Points along ξ, loaded for one chunk of lanes.
template <int W>
struct AxisPoints {
    Lanes<W> basis[axis_terms];  ///< P_m(ξ), m ≥ 1
    Lanes<W> xi;

    template <int Most>
    AxisPoints(const PointLanes<Most>& points, int first) noexcept : xi(load<W>(&points.position[static_cast<std::size_t>(first)])) {
        for (int m = 1; m < axis_terms; ++m)
            basis[m] = load<W>(&points.basis[static_cast<std::size_t>(m)][static_cast<std::size_t>(first)]);
    }
    /// Σ c_m P_m(ξ). @param c [coefficients of the axis]
    [[nodiscard]] Lanes<W> along(const double* c) const noexcept {
        Lanes<W> value(c[0]);
        for (int m = 1; m < axis_terms; ++m) value += c[m] * basis[m];
        return value;
    }
    /// Contributions of point forces to each coordinate, before they are summed over the points: in the order of Difference.
    /// @param terms [2 axis_terms + 2]
    void spread(const Lanes<W>& fx, const Lanes<W>& fy, const Lanes<W>& fz, Lanes<W>* terms) const noexcept {
        terms[0] = fx;
        terms[axis_terms] = fy;
        for (int m = 1; m < axis_terms; ++m) {
            terms[m] = fx * basis[m];
            terms[axis_terms + m] = fy * basis[m];
        }
        terms[2 * axis_terms] = fz;
        terms[2 * axis_terms + 1] = fz * xi;
    }
};

/// The elastic force for several elements side by side.
template <int W, class Books>
[[nodiscard]] inline Lanes<W> element_forces(const BendingLanes& springs, const Lanes<W>& u, const Lanes<W>& rate, Books& books) noexcept {
    const auto stiffness = load<W>(springs.stiffness.data()), damping = load<W>(springs.damping.data());
    books.store(Energy::inner, stiffness * u * u, 0.5);
    books.lose(Loss::inner, damping * rate * rate);
    return stiffness * u + damping * rate;
}

/// Bending modes 2…P of both halves, split along travel and height; lanes: rear 2…P, front 2…P. Adds forces; returns the moment on the
/// link. q [coordinates of the link], v [m/s, rad/s], f [N, N·m]
template <class Books>
[[nodiscard]] inline double bending(const Coefficients& c, const LinkFrame& frame, const double* q, const double* v, double* f,
                                    Books& books) noexcept {
    constexpr int modes = axis_order - 1;
    constexpr int xa = link_layout.x(End::rear, 2), xb = link_layout.x(End::front, 2), ya = link_layout.y(End::rear, 2),
                  yb = link_layout.y(End::front, 2);
    using V = Lanes<2 * modes>;
    const auto both = [](const double* from, int rear, int front) {
        return join<modes>(load<modes>(from + rear), load<modes>(from + front));
    };
    const auto add = [f](int begin, const Lanes<modes>& force) { (load<modes>(f + begin) + force).copy_to(f + begin); };
    const V qx = both(q, xa, xb), qy = both(q, ya, yb), vx = both(v, xa, xb), vy = both(v, ya, yb);
    const V along = qx * frame.tx + qy * frame.ty, across = qy * frame.tx - qx * frame.ty;
    const V along_rate = vx * frame.tx + vy * frame.ty + frame.turning * across;
    const V across_rate = vy * frame.tx - vx * frame.ty - frame.turning * along;
    const V ft = element_forces<2 * modes>(c.travel, along, along_rate, books);
    const V fn = element_forces<2 * modes>(c.height, across, across_rate, books);
    const V fx = fn * frame.ty - ft * frame.tx, fy = -(ft * frame.ty + fn * frame.tx);
    add(xa, half<2 * modes>(fx, 0));
    add(xb, half<2 * modes>(fx, 1));
    add(ya, half<2 * modes>(fy, 0));
    add(yb, half<2 * modes>(fy, 1));
    return sum<2 * modes>(fn * along - ft * across);
}

/// Guides' forces on one link.
template <class Books>
inline void guide_force(const GuideCoefficients& g, const double* q, const double* v, double* f, Books& books) noexcept {
    constexpr int size = link_layout.link_size();
    Lanes<1> place[size], rate[size], force[size];
    for (int k = 0; k < size; ++k) place[k] = q[k], rate[k] = v[k], force[k] = f[k];
    guide_force(g, place, rate, force, books);
    for (int k = 0; k < size; ++k) f[k] = force[k][0];
}

/// All plates of a link, one after the other. Adds to the generalized forces f of the link. q [coordinates of the link], v [m/s], f [N,
/// N·m]
template <class Books>
inline void plates(const Coefficients& c, const LinkKind& kind, const LinkFrame& of, const double* q, const double* v, double* f,
                   Books& books) noexcept {
    constexpr int size = link_layout.link_size();
    using V = Lanes<1>;
    const LinkFrameOf<V> frame{of.tx, of.ty, of.inverse_length, of.turning};
    V place[size], moving[size], force[size];
    for (int k = 0; k < size; ++k) place[k] = q[k], moving[k] = v[k], force[k] = f[k];
    const PackOpening<V> rate(Difference<V>(moving, End::front, moving, End::rear), frame);
    const auto slide = [&](int, const PlateStretch<1>& stretch, const V& speed) { return plate_slide(c, stretch, speed); };
    const auto pull = pack_force<1>(c.plates, pack_place(place, frame, V(kind.free_length)), rate, frame, books, slide);
    pull.apply(1.0, force, End::front);
    pull.apply(-1.0, force, End::rear);
    for (int k = 0; k < size; ++k) f[k] = force[k][0];
}

/// Adds the sums of terms over their lanes.
template <int W>
inline void add_sums(const JointTerms<W>& terms, JointForce<>& to) noexcept {
    alignas(64) double total[JointForce<>::rows];
    sums<W>(terms, total);
    to.add(total);
}

/// The joint between the front half of the link at q_before and the rear half of the one at q_after. q_before [coordinates of the link],
/// v_before [m/s]
template <int W, class Books>
inline void joint(const Coefficients& c, const LinkFrame& before, const LinkFrame& after, const double* q_before, const double* v_before,
                  const double* q_after, const double* v_after, JointForce<>& out, Books& books) noexcept {
    const auto place = joint_place(c.joint, before, after, Difference<>(q_before, End::front, q_after, End::rear),
                                   Difference<>(v_before, End::front, v_after, End::rear));
    const AxisPoints<W> points(c.joint_points, 0);
    const Lanes<W> weight = load<W>(c.joint_points.weight.data());
    const auto motion = joint_motion<W>(c.joint, place, points);
    const auto friction = [&](const Lanes<W>& normal) { return rolling_friction<W>(c.joint, motion, normal, books); };
    add_sums<W>(rolling_contact_force<W>(c.joint, place.frames, points, weight, motion, books, friction), out);
    if (all_at_most<W>(beyond_clearance<W>(c.joint, place.frames, motion), 0.0)) return;  // rolling keeps the centres on the bisector
    add_sums<W>(clearance_force<W>(c.joint, place.frames, points, weight, motion, books), out);
}

/// Phases of one link.
[[nodiscard]] inline PhaseLanes phases_of_link(const Phase* phases) noexcept {
    constexpr std::uint32_t stick_or_slip = 0x02020202;
    return {phases, 1, (phase_word(phases) & stick_or_slip) != 0, tips_per_link};
}

/// 1 where a tip of a link touches, else 0.
[[nodiscard]] inline TipLanes touching_lanes(const Phase* phases) noexcept {
    const auto touching_at = [&](int corner) { return phases[corner] == Phase::free ? 0.0 : 1.0; };
    return join<2>(join<1>(touching_at(0), touching_at(1)), join<1>(touching_at(2), touching_at(3)));
}

/// Adds generalized forces of the four tips to those of their link; returns the moment about z on it. f [N, N·m]
[[nodiscard]] inline double load_link(const TipAction<TipLanes>& action, double* f) noexcept {
    alignas(64) double number[5][4];
    action.total.x.copy_to(number[0]);
    action.total.y.copy_to(number[1]);
    action.total.z.copy_to(number[2]);
    action.tilt_x.copy_to(number[3]);
    action.tilt_y.copy_to(number[4]);
    const auto of = [&](int tip) {
        return TipAction<double>{{number[0][tip], number[1][tip], number[2][tip]}, number[3][tip], number[4][tip], 0.0};
    };
    load_end(End::rear, of(0), of(1), f);
    load_end(End::front, of(2), of(3), f);
    return sum<tips_per_link>(action.moment);
}

/// Reactions of the four tips of a link on the two sheaves.
[[nodiscard, gnu::always_inline]] inline SheaveLoad load_sheaves(const TipGeometry<TipLanes>& g, const TipMotion<TipLanes>& motion,
                                                                 const TipForces<TipLanes>& t) noexcept {
    const auto pair = [](const TipLanes& lanes, double* two) { folded<tips_per_link>(lanes).copy_to(two); };  // rear + front, by side
    const auto [force, moment] = tip_reaction(g, motion, t);
    SheaveLoad load;
    pair(force.x, load.fx);
    pair(force.y, load.fy);
    pair(force.z, load.fz);
    pair(moment.x, load.mx);
    pair(moment.y, load.my);
    pair(moment.z, load.mz);
    return load;
}

/// All tips of a link; `sheaves` are the two of its pulley. Adds to the link's generalized forces, returns the moment about z on it.
template <class Books>
[[nodiscard]] inline double tips(const Coefficients& c, const LinkFrame& frame, const double* q, const double* v,
                                 const SheaveMotion* sheaves, const Phase* phases, double* f, SheaveLoad& load, Books& books) noexcept {
    const FourTips four;
    const auto sheave = sheaves_at(four, sheaves);
    const auto geometry = tip_geometry(c, four, frame, q, sheave);
    const auto motion = tip_motion(c, four, frame, v, sheave, geometry);
    const auto forces = tip_forces<tips_per_link>(c.tip, geometry, motion, touching_lanes(phases), phases_of_link(phases), books);
    load = load_sheaves(geometry, motion, forces);
    return load_link(tip_action(c, frame, geometry, motion, forces), f);
}

/// Calls body with the smallest compiled lane count that holds `width`.
template <class Body>
inline void with_lanes(int width, const Body& body) noexcept {
    if (width == 1) return body.template operator()<1>();
    if (width == 2) return body.template operator()<2>();
    if (width <= 4) return body.template operator()<4>();
    if (width <= 8) return body.template operator()<8>();
    return body.template operator()<16>();
}

/// Elasticity and plates of a link. Clears and fills its generalized forces f; returns the moment about z on it. state [unknowns of the
/// link], f [N, N·m]
template <class Books>
[[nodiscard]] inline double link_part(const Coefficients& c, int link, const LinkFrame& frame, const double* state, double* f,
                                      Books& books) noexcept {
    const double* v = state + link_layout.link_size();
    std::memset(f, 0, static_cast<std::size_t>(link_layout.link_size()) * sizeof(double));
    const LinkKind& kind = c.kind(link);
    const double moment = inner_elasticity(c, kind, frame, state, v, f, books);
    if (!c.longer.empty()) add_lengths(c, lengths_at(c, link), state, f, books);
    plates(c, kind, frame, state, v, f, books);
    return moment;
}

/// Joint between two links with their states and frames. state_before [states of a link]
template <class Books>
inline void joint_part(const Coefficients& c, const LinkFrame& before, const LinkFrame& after, const double* state_before,
                       const double* state_after, JointForce<>& out, Books& books) noexcept {
    constexpr int size = link_layout.link_size();
    out = {};
    with_lanes(c.joint_points.width, [&]<int W>() {
        joint<W>(c, before, after, state_before, state_before + size, state_after, state_after + size, out, books);
    });
}

/// Replaces `blocks` vectors of N numbers, N apart, by their products with the inverse: its columns times the vector's numbers, summed in
/// their order. Each column is loaded once for all blocks.
template <int N, int blocks>
inline void multiply(const SmallInverse& inverse, double* f) noexcept {
    constexpr int width = padded(N);
    std::array<Lanes<width>, blocks> total;
    for (int k = 0; k < N; ++k) {
        const auto column = load<width>(inverse.column.data() + k * width);
        for (std::size_t block = 0; block < blocks; ++block) {
            const auto term = f[static_cast<int>(block) * N + k] * column;
            total[block] = k == 0 ? term : total[block] + term;
        }
    }
    for (std::size_t block = 0; block < blocks; ++block) {
        alignas(64) double buffer[width];
        total[block].copy_to(buffer);
        std::memcpy(f + block * N, buffer, N * sizeof(double));
    }
}

/// Accelerations of a link from its generalized forces, in place. f [in: N, N·m; out: m/s², rad/s²]
inline void accelerate(const LinkInertia& inertia, double* f) noexcept {
    multiply<2 * axis_terms, 2>(inertia.lateral, f);
    multiply<4, 1>(inertia.axial, f + 4 * axis_terms);
}

/// Forces of the tips of one link, kept apart until they are added.
struct TipShare {
    double force[4 * axis_terms + 4];
    double moment;  ///< moment about z [N·m]
};

/// Tips of a link that touches somewhere; reactions on its sheaves to `load`. state [unknowns of the link]
template <class Books>
inline void tip_part(const ChainModel& model, const LinkFrame& frame, const double* state, const SheaveMotion* sheaves, const Phase* phases,
                     TipShare& share, LinkLoad& load, Books& books) noexcept {
    std::memset(share.force, 0, sizeof share.force);
    load.shaft = model.shaft_of(state);
    share.moment = tips(model.coefficients(), frame, state, state + link_layout.link_size(), sheaves + 2 * load.shaft, phases, share.force,
                        load.load, books);
}

/// Adds joints and tips (none: nullptr) to the results of link_part in f. The order of the sums keeps the bits equal. moment [N·m]
inline void assemble(const LinkFrame& frame, double moment, const JointForce<>& rear, const JointForce<>& front, const TipShare* tips,
                     double* f) noexcept {
    rear.on_front.apply(-1.0, f, End::rear);
    front.on_front.apply(1.0, f, End::front);
    moment += rear.after + front.before;
    if (tips != nullptr) {
        for (int k = 0; k < link_layout.link_size(); ++k) f[k] += tips->force[k];
        moment += tips->moment;
    }
    add_moment(frame, moment, f);
}

}  // namespace
}  // namespace cvtflow::model
