#pragma once
/// One pass of an implicit sweep (model/contact/friction_operator.hpp), and what the forces dissipate that sweeps have found, lanes over
/// links.

#include "model/contact/contact_lanes.hpp"
#include "model/contact/friction_operator.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

/// Forces of W links that are kept from step to step. @tparam Number float, or const float
template <int W, class Number>
struct KeptForces {
    using V = Lanes<W>;

    const LinkLanes<W> links;
    const LaneRows<W, Number> now;  ///< [SweepRows::count()] rows
    const SweepRows rows{links.field.components.joint_points};

    /// Force of a tip on its link; shares turn with the link.
    [[nodiscard]] AtTip<V> tip(int corner) const noexcept {
        const V friction_limit = links.contact[links.field.components.tip(corner) + ContactComponents::Tip::friction_limit];
        const V tx = links.contact[ContactComponents::frame_x], ty = links.contact[ContactComponents::frame_y];
        const int row = rows.tip(corner);
        const V along = now[row], across = now[row + 1];
        return {friction_limit * (along * tx - across * ty), friction_limit * (along * ty + across * tx), friction_limit * now[row + 2]};
    }
    /// Keeps the forces with which the next step begins, of rows [first, last). @param ahead FrictionSweep::ahead
    void keep_opening(int first, int last, const LaneRows<W, const float>& before, float ahead) const noexcept {
        for (int row = first; row < last; ++row) now.put(rows.opening(row), now[row] + ahead * (now[row] - before[row]));
    }
};

/// Sliding of point g across the axis, at rates that other points have changed.
template <int W>
[[nodiscard]] inline Lanes<W> slip_across(const JointContacts<W>& joints, int g, const typename JointContacts<W>::Rates& rates) noexcept {
    Lanes<W> x = rates.x[0], y = rates.y[0];
    for (int m = 1; m < axis_terms; ++m) {
        x += joints.basis(m, g) * rates.x[m];
        y += joints.basis(m, g) * rates.y[m];
    }
    return joints.slip(g, x, y, rates);
}

/// Powers of kept forces at the velocities of the range.
template <int W>
class SweepPowers {
public:
    using V = Lanes<W>;

    SweepPowers(const FrictionOperator& friction, const LinkLanes<W>& links, const FloatColumns& kept) noexcept
        : links_(links), joints_{links, friction.numbers()}, tips_{links}, kept_{links, links.rows_of(kept)} {}

    /// @param powers [links of the range]
    void run(FrictionPowers* powers) const noexcept {
        float of_kind[3][static_cast<std::size_t>(lane_count<W>)];
        joint_power().copy_to(of_kind[0]);
        plate_power().copy_to(of_kind[1]);
        tip_power().copy_to(of_kind[2]);  // a tip may have lifted at the step's end
        const int lanes = links_.count();
        for (int lane = 0; lane < lanes; ++lane) powers[links_.group + lane] = {of_kind[0][lane], of_kind[1][lane], of_kind[2][lane]};
    }

private:
    [[nodiscard]] V joint_power() const noexcept {
        const auto rates = joints_.rates();
        V sum(0.0);
        for (int g = 0; g < joints_.points(); ++g) {
            const V along = rates.z + joints_.position(g) * rates.e;
            const int row = kept_.rows.joint(g);
            sum += joints_.contact(g, ContactComponents::Joint::friction_limit) *
                   (kept_.now[row] * slip_across(joints_, g, rates) + kept_.now[row + 1] * along);
        }
        return -sum;
    }

    [[nodiscard]] V plate_power() const noexcept {
        const auto [z, e] = links_.plate_rates();
        return -(kept_.now[kept_.rows.plates()] * z + kept_.now[kept_.rows.plates() + 1] * e);
    }

    [[nodiscard]] V tip_power() const noexcept {
        const V turn = links_.turning();
        V sum(0.0);
        for (const End end : {End::rear, End::front}) {
            const int low = 2 * static_cast<int>(end);
            const AtTips<V> v = tips_.velocities(end);
            for (const auto& [moving, corner] : {std::pair{&v.low, low}, std::pair{&v.high, low + 1}}) {
                const AtTip<V> sliding = tips_.slip(corner, *moving, turn), force = kept_.tip(corner);
                sum += force.x * sliding.x + force.y * sliding.y + force.z * sliding.z;
            }
        }
        return -sum;
    }

    const LinkLanes<W> links_;
    const JointContacts<W> joints_;
    const TipContacts<W> tips_;
    const KeptForces<W, const float> kept_;
};

inline void sweep_powers(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range, const FloatColumns& kept,
                         FrictionPowers* powers) noexcept {
    over_groups(0, range.last - range.first, [&]<int W>(int group) { SweepPowers<W>(friction, {field, range, group}, kept).run(powers); });
}

/// A pass over the joints of the rear pins of W links.
template <int W, class Laws>
class JointSweep {
public:
    using V = Lanes<W>;
    using Joints = JointContacts<W>;

    JointSweep(const FrictionOperator& friction, const LinkLanes<W>& links, const FrictionSweep& sweep) noexcept
        : joints_{links, friction.numbers()},
          curve_(friction.chain().coefficients().joint.friction),
          friction_{links, links.rows_of(*sweep.kept)},
          before_(links.rows_of(*sweep.before)),
          sweep_(sweep),
          responses_(*sweep.responses) {}

    /// Finds their forces, for the links on both sides.
    void run() const noexcept {
        V force[Joints::rows];
        for (V& row : force) row = V(0.0);
        const int points = joints_.points();
        if (sweep_.part == SweepPart::opening) {
            for (int g = 0; g < points; ++g) open_point(g, force);
        } else {
            Rates rates = joints_.rates();
            for (int k = 0; k < points; ++k)  // from both ends to the middle
                solve_point(k % 2 == 0 ? k / 2 : points - 1 - k / 2, rates, force);
        }
        if (sweep_.part == SweepPart::closing) friction_.keep_opening(0, friction_.rows.plates(), before_, sweep_.ahead);
        JointForces<W>(joints_.links.range).put(joints_.links.group, force);
    }

private:
    using Joint = ContactComponents::Joint;
    using Rates = typename Joints::Rates;
    static constexpr int n = axis_terms;

    /// Adds a force across the axis and along it at point g.
    void add_point(int g, const V& across, const V& along, V* force) const noexcept {
        const V x = -(joints_.contact(g, Joint::normal_y) * across), y = joints_.contact(g, Joint::normal_x) * across;
        force[0] += x;
        force[n] += y;
        for (int m = 1; m < n; ++m) {
            force[m] += joints_.basis(m, g) * x;
            force[n + m] += joints_.basis(m, g) * y;
        }
        force[Joints::z] += along;
        force[Joints::e] += joints_.position(g) * along;
        force[Joints::moment_before] += across * joints_.contact(g, Joint::lever_before);
        force[Joints::moment_after] += across * joints_.contact(g, Joint::lever_after);
    }

    void open_point(int g, V* force) const noexcept {
        const SweepRows& rows = friction_.rows;
        const V friction_limit = joints_.contact(g, Joint::friction_limit);
        const V across = before_[rows.opening(rows.joint(g))], along = before_[rows.opening(rows.joint(g) + 1)];
        friction_.now.put(rows.joint(g), across);
        friction_.now.put(rows.joint(g) + 1, along);
        friction_.now.put(rows.joint_speed(g), before_[rows.joint_speed(g)]);
        add_point(g, friction_limit * across, friction_limit * along, force);
    }

    /// Force at point g for the sliding that all others leave it (…_without: without this point's friction; full_…: the sliding that its
    /// full friction removes); adds its change to `force` and the response to it to the rates.
    void solve_point(int g, Rates& rates, V* force) const noexcept {
        const auto at_g = static_cast<std::size_t>(g);
        const int row = friction_.rows.joint(g);
        const V friction_limit = joints_.contact(g, Joint::friction_limit);
        const V across = friction_.now[row], along = friction_.now[row + 1];
        const V full_across = responses_.joint_across[at_g] * friction_limit, full_along = responses_.joint_along[at_g] * friction_limit;
        const V across_without = slip_across(joints_, g, rates) - full_across * across;
        const V along_without = rates.z + joints_.position(g) * rates.e - full_along * along;
        const V speed = sliding_speed(g, {across_without, along_without}, {full_across, full_along});
        const Reciprocals<W> inverse(speed + full_across, speed + full_along);
        const V new_across = -(across_without * inverse.first), new_along = -(along_without * inverse.second);
        friction_.now.put(row, new_across);
        friction_.now.put(row + 1, new_along);
        const V change = friction_limit * (new_across - across), push = friction_limit * (new_along - along);
        add_point(g, change, push, force);
        const V x = -(joints_.contact(g, Joint::normal_y) * change), y = joints_.contact(g, Joint::normal_x) * change;
        for (int m = 0; m < n; ++m) {
            rates.x[m] += responses_.joint_lateral[at_g][static_cast<std::size_t>(m)] * x;
            rates.y[m] += responses_.joint_lateral[at_g][static_cast<std::size_t>(m)] * y;
        }
        rates.z += responses_.joint_shift * push;
        rates.e += responses_.joint_tilt[at_g] * push;
    }

    /// D = v/s of the law at a point's sliding speed v: Σ (without/(D + full))² = s², one step of Newton's method from the last one on.
    [[nodiscard]] V sliding_speed(int g, const V (&without)[2], const V (&full)[2]) const noexcept {
        const int row = friction_.rows.joint_speed(g);
        const V from = larger<W>(friction_.now[row], V(curve_.saturation_speed));
        const Reciprocals<W> inverse(from + full[0], from + full[1]);
        const V across = without[0] * inverse.first, along = without[1] * inverse.second;
        const V a = across * across, b = along * along, sum = a + b;
        const V slope = a * inverse.first + b * inverse.second + V(1e-20);
        const V speed = divisor_left<W, Laws>(curve_, from + sum * (sqrt(sum) - V(1.0)) / slope, sum / slope - from);
        friction_.now.put(row, speed);
        return speed;
    }

    const Joints joints_;
    const FrictionCurve& curve_;
    const KeptForces<W, float> friction_;
    const LaneRows<W, const float> before_;
    const FrictionSweep& sweep_;
    const SweepResponses& responses_;
};

/// A pass over W links, with their plates and tips; their joints must be in scratch.
template <int W, class Laws>
class LinkSweep {
public:
    using V = Lanes<W>;

    LinkSweep(const FrictionOperator& friction, const LinkLanes<W>& links, const FrictionSweep& sweep) noexcept
        : operator_(friction), links_(links), sweep_(sweep) {}

    /// Velocities of the links.
    void run() const noexcept {
        const bool opening = sweep_.part == SweepPart::opening, closing = sweep_.part == SweepPart::closing;
        const bool touch = !closing && links_.touch();
        const JointForces<W> joints(links_.range);
        V f[link_layout.link_size()];
        joints.act(links_.group, f);
        V moment = joints.moment(links_.group);
        if (opening) open_link(touch, f, moment);
        links_.add_couple(moment, f);
        accelerate(f, closing ? links_.rows_of(*sweep_.result) : velocity_);
        if (closing) return friction_.keep_opening(rows_.plates(), rows_.forces(), before_, sweep_.ahead);
        solve_plates();
        if (touch) solve_tips();
    }

private:
    using Tip = ContactComponents::Tip;
    static constexpr int n = axis_terms;

    void add_velocity(int row, const V& change) const noexcept { velocity_.put(row, links_.velocity[row] + change); }

    /// Forces of plates and tips of the step before.
    void open_link(bool touch, V* f, V& moment) const noexcept {
        for (int k = 0; k < 2; ++k) {
            const V force = before_[rows_.opening(rows_.plates() + k)];
            friction_.now.put(rows_.plates() + k, force);
            friction_.now.put(rows_.plate_rate() + k, before_[rows_.plate_rate() + k]);
            f[link_layout.z(End::front) + k] += force;
            f[link_layout.z(End::rear) + k] = f[link_layout.z(End::rear) + k] - force;
        }
        for (int row = rows_.tip(0); row < rows_.forces(); ++row) friction_.now.put(row, touch ? before_[rows_.opening(row)] : V(0.0));
        if (!touch) return;
        for (const End end : {End::rear, End::front}) {
            const int low = 2 * static_cast<int>(end);
            tips_.act(end, {friction_.tip(low), friction_.tip(low + 1)}, f, moment);
        }
    }

    /// A⁻¹ f.
    void respond(const V* f, V* accelerations) const noexcept {
        const V tx = links_.contact[ContactComponents::frame_x], ty = links_.contact[ContactComponents::frame_y];
        multiply_turned(numbers_.inverse.along, numbers_.inverse.across, tx, ty, f, accelerations);
        multiply_ends<2>(numbers_.inverse.axial, f + 4 * n, accelerations + 4 * n);
    }

    /// Velocities after forces have acted. @param to velocities at ϑ so far, or the result, at the end
    void accelerate(const V* f, const LaneRows<W, float>& to) const noexcept {
        constexpr auto to_end = static_cast<float>(1.0 / sweep_time);
        const bool closing = sweep_.part == SweepPart::closing;
        const float per_step = 1.0F / responses_.step;
        const LaneRows<W, const float> start = links_.rows_of(*sweep_.start), base = links_.rows_of(std::as_const(*sweep_.base));
        V change[link_layout.link_size()];
        respond(f, change);
        for (int row = 0; row < link_layout.link_size(); ++row) {
            V v = links_.velocity[row];
            if (sweep_.part == SweepPart::opening) v = start[row] + responses_.step * base[row];
            v += responses_.step * change[row];
            to.put(row, closing ? start[row] + to_end * (v - start[row]) : v);
            if (!closing || row >= SweepRows::wave_rows) continue;
            const V before = before_[rows_.lasting(row)], now = per_step * (v - start[row]) - base[row];
            friction_.now.put(rows_.lasting(row), before + static_cast<float>(lasting_share) * (now - before));
        }
    }

    /// Plates with the secants of the last rates: two equations for the sliding of both directions.
    void solve_plates() const noexcept {
        const V force_z = friction_.now[rows_.plates()], force_e = friction_.now[rows_.plates() + 1];
        V a(0.0), b(0.0), e(0.0);
        add_secants(a, b, e);
        const auto [rate_z, rate_e] = links_.plate_rates();
        const V z_without = rate_z - responses_.plate_shift * force_z, e_without = rate_e - responses_.plate_tilt * force_e;
        const V zz = V(1.0) + responses_.plate_shift * a, ze = responses_.plate_shift * b, ez = responses_.plate_tilt * b,
                ee = V(1.0) + responses_.plate_tilt * e;
        const V inverse = V(1.0) / (zz * ee - ze * ez);
        const V z = (z_without * ee - ze * e_without) * inverse, tilt = (zz * e_without - ez * z_without) * inverse;
        const V new_z = -(a * z + b * tilt), new_e = -(b * z + e * tilt);
        friction_.now.put(rows_.plate_rate(), z);
        friction_.now.put(rows_.plate_rate() + 1, tilt);
        friction_.now.put(rows_.plates(), new_z);
        friction_.now.put(rows_.plates() + 1, new_e);
        const V shift = responses_.link_shift * (new_z - force_z), turn = responses_.link_tilt * (new_e - force_e);
        add_velocity(link_layout.z(End::front), shift);
        add_velocity(link_layout.z(End::rear), -shift);
        add_velocity(link_layout.e(End::front), turn);
        add_velocity(link_layout.e(End::rear), -turn);
    }

    /// Σ secant, Σ ξ secant, Σ ξ² secant.
    void add_secants(V& a, V& b, V& e) const noexcept {
        const ContactComponents& components = links_.field.components;
        const V z = friction_.now[rows_.plate_rate()], tilt = friction_.now[rows_.plate_rate() + 1];
        const FrictionCurve& curve = operator_.chain().coefficients().plate_friction;
        const auto add = [&](int plate, const V& speed, const V& inverse) {
            const float xi = numbers_.plates.position[static_cast<std::size_t>(plate)];
            const V secant = links_.contact[components.plate(plate)] * slip_factor<W, Laws>(curve, speed, inverse), lever = xi * secant;
            a += secant;
            b += lever;
            e += xi * lever;
        };
        const auto speed = [&](int plate) {
            return regular_speed<W, Laws>(curve, abs(z + numbers_.plates.position[static_cast<std::size_t>(plate)] * tilt));
        };
        int plate = 0;
        for (; plate + 1 < components.plates; plate += 2) {
            const V one = speed(plate), other = speed(plate + 1);
            const Reciprocals<W> inverse(one, other);
            add(plate, one, inverse.first);
            add(plate + 1, other, inverse.second);
        }
        if (plate < components.plates) add(plate, speed(plate), V(1.0) / speed(plate));
    }

    /// All tips at the velocities that they have left each other so far.
    void solve_tips() const noexcept {
        V f[link_layout.link_size()];
        for (V& row : f) row = V(0.0);
        V moment(0.0);
        const V turn = links_.turning();
        for (const End end : {End::rear, End::front}) {
            const int low = 2 * static_cast<int>(end);
            const AtTips<V> velocities = tips_.velocities(end);
            const AtTips<V> changes{solve_tip(low, velocities.low, turn), solve_tip(low + 1, velocities.high, turn)};
            tips_.act(end, changes, f, moment);
        }
        links_.add_couple(moment, f);
        V change[link_layout.link_size()];
        respond(f, change);
        for (int row = 0; row < link_layout.link_size(); ++row) add_velocity(row, responses_.step * change[row]);
    }

    /// Friction is -c u/(D + r c) times the law's factor: u is the slip without this tip's friction, c the limit and r the response.
    /// @return change of its force
    [[nodiscard, gnu::always_inline]] AtTip<V> solve_tip(int corner, const AtTip<V>& v, const V& turn) const noexcept {
        const V friction_limit = tips_.contact(corner, Tip::friction_limit), full_slip = responses_.tip * friction_limit;
        const AtTip<V> old = friction_.tip(corner);
        const AtTip<V> without =
            tips_.slip(corner, {v.x - responses_.tip * old.x, v.y - responses_.tip * old.y, v.z - responses_.tip * old.z}, turn);
        const V speed = sqrt(without.square()), lawful = lawful_share(full_slip, speed), lawful_slip = lawful * full_slip;
        const V factor = -(lawful / (lawful_slip + divisor_left<W, Laws>(curve_, speed - lawful_slip, lawful_slip)));
        const V none(0.0);
        const auto held = [&](const V& sliding) { return select_greater<W>(friction_limit, none, factor * sliding, none); };
        const AtTip<V> part{held(without.x), held(without.y), held(without.z)};
        const V tx = links_.contact[ContactComponents::frame_x], ty = links_.contact[ContactComponents::frame_y];
        friction_.now.put(rows_.tip(corner), part.x * tx + part.y * ty);
        friction_.now.put(rows_.tip(corner) + 1, part.y * tx - part.x * ty);
        friction_.now.put(rows_.tip(corner) + 2, part.z);
        const V forces[3] = {friction_limit * part.x, friction_limit * part.y, friction_limit * part.z};
        const LaneRows<W, float> means = links_.rows_of(*sweep_.mean_tip_forces);
        for (int axis = 0; axis < 3; ++axis) means.put(3 * corner + axis, forces[axis]);
        return {forces[0] - old.x, forces[1] - old.y, forces[2] - old.z};
    }

    /// Factor of the tips' law at the sliding speed that friction leaves. @param full_slip sliding that full friction removes [m/s]
    [[nodiscard]] V lawful_share(const V& full_slip, const V& speed) const noexcept {
        if (numbers_.tip_law == nullptr) return V(1.0);
        return speed_factor<W>(*numbers_.tip_law, braked_speed<W>(*numbers_.tip_law, full_slip, speed, V(curve_.saturation_speed)));
    }

    const FrictionOperator& operator_;
    const LinkLanes<W> links_;
    const FrictionSweep& sweep_;
    const FrictionNumbers& numbers_ = operator_.numbers();
    const FrictionCurve& curve_ = operator_.chain().coefficients().tip.friction;
    const SweepResponses& responses_ = *sweep_.responses;
    const TipContacts<W> tips_{links_};
    const KeptForces<W, float> friction_{links_, links_.rows_of(*sweep_.kept)};
    const LaneRows<W, const float> before_ = links_.rows_of(*sweep_.before);
    const LaneRows<W, float> velocity_ = links_.rows_of(*sweep_.velocity);
    const SweepRows rows_ = friction_.rows;
};

/// Plates along their links, and joints along their normals, as if they were deflected by u + β h² u'', where u'' is by all forces but
/// friction and by friction as it lasts. Accelerations are in the place of the links' velocities.
template <int W>
class WaveFilter {
public:
    using V = Lanes<W>;
    using Joints = JointContacts<W>;

    WaveFilter(const FrictionOperator& friction, const LinkLanes<W>& links) noexcept
        : numbers_(friction.numbers()), arm_(friction.chain().coefficients().joint.arm), links_(links) {}

    /// Forces of the joints of their rear pins, to scratch.
    void joints() const noexcept {
        const Joints joints{links_, numbers_};
        const LaneRows<W, const float> before = links_.before().contact;
        const auto rates = joints.rates();
        const int middle = joints.points() / 2;
        const V nx = joints.contact(middle, ContactComponents::Joint::normal_x),
                ny = joints.contact(middle, ContactComponents::Joint::normal_y);
        const auto lever = [&](const LaneRows<W, const float>& frame) {
            return arm_ * (frame[ContactComponents::frame_x] * ny - frame[ContactComponents::frame_y] * nx);
        };
        const V lever_before = lever(before), lever_after = lever(links_.contact);
        V gap[n], force[Joints::rows];
        for (int m = 0; m < n; ++m) gap[m] = nx * rates.x[m] + ny * rates.y[m];
        gap[0] += lever_before * rates.before + lever_after * rates.after;
        for (int m = 0; m < n; ++m) {
            const V pull = product(numbers_.inverse.wave_joint, m, gap);
            if (m == 0) force[Joints::moment_before] = -(lever_before * pull), force[Joints::moment_after] = -(lever_after * pull);
            force[m] = -(pull * nx);
            force[n + m] = -(pull * ny);
        }
        force[Joints::z] = force[Joints::e] = V(0.0);
        JointForces<W>(links_.range).put(links_.group, force);
    }

    /// Takes the lasting accelerations off, and adds those by the filter. @param before FrictionSweep::before
    void links(FloatColumns& base, const FloatColumns& before) const noexcept {
        const V tx = links_.contact[ContactComponents::frame_x], ty = links_.contact[ContactComponents::frame_y];
        const JointForces<W> joints(links_.range);
        V f[link_layout.link_size()], stretch[n];
        joints.act(links_.group, f);
        links_.add_couple(joints.moment(links_.group), f);
        const auto apart = [&](int front, int rear) { return links_.velocity[front] - links_.velocity[rear]; };
        for (int m = 0; m < n; ++m)
            stretch[m] = tx * apart(link_layout.x(End::front, m), link_layout.x(End::rear, m)) +
                         ty * apart(link_layout.y(End::front, m), link_layout.y(End::rear, m));
        stretch[0] += links_.contact[ContactComponents::outward];
        for (int m = 0; m < n; ++m) {
            const V pull = product(numbers_.inverse.wave_plates, m, stretch), x = pull * tx, y = pull * ty;
            f[link_layout.x(End::rear, m)] += x;
            f[link_layout.y(End::rear, m)] += y;
            f[link_layout.x(End::front, m)] = f[link_layout.x(End::front, m)] - x;
            f[link_layout.y(End::front, m)] = f[link_layout.y(End::front, m)] - y;
        }
        multiply_turned(numbers_.inverse.along, numbers_.inverse.across, tx, ty, f, f);
        const LaneRows<W, float> to = links_.rows_of(base);
        const LaneRows<W, const float> lasting = links_.rows_of(before);
        const SweepRows rows{links_.field.components.joint_points};
        for (int row = 0; row < SweepRows::wave_rows; ++row) to.put(row, to[row] - lasting[rows.lasting(row)] + f[row]);
    }

private:
    static constexpr int n = axis_terms;

    [[nodiscard]] static V product(const AxisMatrix<float>& matrix, int row, const V* modes) noexcept {
        const float* first = matrix.data() + row * n + row % 2;
        return first[0] * modes[row % 2] + first[2] * modes[row % 2 + 2];
    }

    const FrictionNumbers& numbers_;
    const double arm_;  ///< lever of a link's turning along its joints' normals [m]
    const LinkLanes<W> links_;
};

inline void filter_waves(const FrictionOperator& friction, const ContactField& field, FrictionRange range,
                         const FrictionSweep& sweep) noexcept {
    const int links = range.last - range.first;
    range.velocity = sweep.base->at(0, range.first + range.shift - 1);
    range.stride = sweep.base->stride();
    over_groups(0, links + 1, [&]<int W>(int group) { WaveFilter<W>(friction, {field, range, group}).joints(); });
    over_groups(0, links, [&]<int W>(int group) { WaveFilter<W>(friction, {field, range, group}).links(*sweep.base, *sweep.before); });
}

/// A pass over the links of a range: their joints, then the links.
inline void sweep_links(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range,
                        const FrictionSweep& sweep) noexcept {
    const int links = range.last - range.first;
    if (sweep.part == SweepPart::opening && friction.numbers().filter_waves()) filter_waves(friction, field, range, sweep);
    FrictionLaws::visit(friction.chain().coefficients().tip.friction.law, [&](auto law) {
        using Laws = LawList<decltype(law)>;
        over_groups(0, links + 1, [&]<int W>(int group) { JointSweep<W, Laws>(friction, {field, range, group}, sweep).run(); });
        over_groups(0, links, [&]<int W>(int group) { LinkSweep<W, Laws>(friction, {field, range, group}, sweep).run(); });
    });
}

}  // namespace
}  // namespace cvtflow::model
