#pragma once
/// One pass of an implicit sweep (model/contact/sweep_step.hpp), and what the forces dissipate that sweeps have found, lanes over links.
/// Every lane does the same operations in the same order whatever its neighbours are, so results do not depend on how links are grouped.

#include "model/contact/friction_lanes.hpp"
#include "model/contact/sweep_step.hpp"

namespace cvtflow::model {
namespace {

/// W links side by side; column numbers count from the first link of the range.
template <int W>
class SweepForces : protected FrictionLanes<W, false> {
    using Base = FrictionLanes<W, false>;

public:
    using typename Base::V;

    /// @param kept_forces [SweepRows::count()] rows
    SweepForces(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range,
                const FloatColumns& kept_forces) noexcept
        : Base(friction, field, range), rows_{field.components.joint_points}, kept_forces_(kept_forces) {}

    /// Powers of links first + group … + W - 1, at the velocities of the range. powers [links of the range]
    void powers(int group, FrictionPowers* powers) const noexcept {
        const int lanes = Base::links_at(group);
        float of_kind[3][static_cast<std::size_t>(lane_count<W>)];
        joint_power(group).copy_to(of_kind[0]);
        plate_power(group).copy_to(of_kind[1]);
        tip_power(group).copy_to(of_kind[2]);  // a tip may have lifted at the step's end
        for (int lane = 0; lane < lanes; ++lane) powers[group + lane] = {of_kind[0][lane], of_kind[1][lane], of_kind[2][lane]};
    }

protected:
    using Base::basis, Base::contact, Base::column, Base::numbers_, Base::field_, Base::in_scratch, Base::to_scratch, Base::velocity,
        Base::slip, Base::n;
    using typename Base::Joint, typename Base::Tip, typename Base::JointRates;

    [[nodiscard]] V kept_row(int row, int group) const noexcept { return load<W>(kept_forces_.at(row, column(group))); }

    /// Sliding of point g across the axis, at rates that other points have changed.
    [[nodiscard]] V slip_across(int group, int g, const JointRates& rates) const noexcept {
        V x = rates.x[0], y = rates.y[0];
        for (int m = 1; m < n; ++m) {
            x += basis(m, g) * rates.x[m];
            y += basis(m, g) * rates.y[m];
        }
        return Base::slip_of(group, g, x, y, rates);
    }

    /// Force of a kept share; shares turn with the link.
    [[nodiscard]] AtTip<V> tip_force(int group, int corner) const noexcept {
        const int row = rows_.tip(corner);
        const V friction_limit = contact(field_.components.tip(corner) + Tip::friction_limit, group);
        const V tx = contact(ContactComponents::frame_x, group), ty = contact(ContactComponents::frame_y, group);
        const V along = kept_row(row, group), across = kept_row(row + 1, group);
        return {friction_limit * (along * tx - across * ty), friction_limit * (along * ty + across * tx),
                friction_limit * kept_row(row + 2, group)};
    }

    const SweepRows rows_;

private:
    [[nodiscard]] V joint_power(int group) const noexcept {
        const JointRates rates = Base::joint_rates(group);
        V sum(0.0);
        for (int g = 0; g < rows_.joint_points; ++g) {
            const V along = rates.z + numbers_.joint_position[static_cast<std::size_t>(g)] * rates.e;
            sum += contact(field_.components.joint(g) + Joint::friction_limit, group) *
                   (kept_row(rows_.joint(g), group) * slip_across(group, g, rates) + kept_row(rows_.joint(g) + 1, group) * along);
        }
        return -sum;
    }

    [[nodiscard]] V plate_power(int group) const noexcept {
        const auto [z, e] = Base::plate_rates(group);
        return -(kept_row(rows_.plates(), group) * z + kept_row(rows_.plates() + 1, group) * e);
    }

    [[nodiscard]] V tip_power(int group) const noexcept {
        const V turn = Base::turning(group);
        V sum(0.0);
        for (const End end : {End::rear, End::front}) {
            const int low = 2 * static_cast<int>(end);
            const AtTips<V> v = Base::tip_velocities(group, {link_layout.x(end, 0), link_layout.y(end, 0), link_layout.z(end)});
            for (const auto& [moving, corner] : {std::pair{&v.low, low}, std::pair{&v.high, low + 1}}) {
                const AtTip<V> sliding = Base::slip(group, corner, *moving, turn), force = tip_force(group, corner);
                sum += force.x * sliding.x + force.y * sliding.y + force.z * sliding.z;
            }
        }
        return -sum;
    }

    const FloatColumns& kept_forces_;
};

inline void sweep_powers(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range, const FloatColumns& kept,
                         FrictionPowers* powers) noexcept {
    over_groups(0, range.last - range.first, [&]<int W>(int group) { SweepForces<W>(friction, field, range, kept).powers(group, powers); });
}

/// W links side by side; column numbers count from the first link of the range.
template <int W>
class SweepLanes : private SweepForces<W> {
    using Base = SweepForces<W>;
    using Base::add_couple, Base::basis, Base::column, Base::contact, Base::to_scratch, Base::in_scratch, Base::numbers_, Base::slip,
        Base::field_, Base::velocity, Base::kept_row, Base::tip_force, Base::slip_across, Base::rows_, Base::n, Base::joint_rows;
    using typename Base::JointRates, typename Base::Joint, typename Base::Tip;

public:
    using typename Base::V;

    SweepLanes(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range, const FrictionSweep& sweep) noexcept
        : Base(friction, field, range, *sweep.kept), sweep_(sweep), responses_(*sweep.responses) {}

    /// Joint of the rear pins of links first + group … + W - 1, its force to scratch.
    void joints(int group) const noexcept {
        V force[joint_rows];
        for (V& row : force) row = V(0.0);
        if (sweep_.part == SweepPart::opening) {
            for (int g = 0; g < rows_.joint_points; ++g) open_point(group, g, force);
        } else {
            JointRates rates = Base::joint_rates(group);
            for (int k = 0; k < rows_.joint_points; ++k)  // from both ends to the middle
                solve_point(group, k % 2 == 0 ? k / 2 : rows_.joint_points - 1 - k / 2, rates, force);
        }
        for (int row = 0; row < joint_rows; ++row) to_scratch(row, group, force[row]);
    }

    /// Velocities of links first + group … + W - 1; their joints must be in scratch.
    void links(int group) const noexcept {
        const bool opening = sweep_.part == SweepPart::opening, closing = sweep_.part == SweepPart::closing;
        const bool touch = !closing && Base::touching(group);
        V f[link_layout.link_size()];
        Base::add_joints(group, f);
        V moment = in_scratch(2 * n + 3, group) + in_scratch(2 * n + 2, group + 1);
        if (opening) open_link(group, touch, f, moment);
        add_couple(group, moment, f);
        accelerate(group, f, closing ? *sweep_.result : *sweep_.velocity);
        if (closing) return keep_opening(group);
        solve_plates(group);
        if (touch) solve_tips(group);
    }

private:
    [[nodiscard]] V before(int row, int group) const noexcept { return load<W>(sweep_.before->at(row, column(group))); }
    void put(int row, int group, const V& lanes) const noexcept { lanes.copy_to(sweep_.kept->at(row, column(group))); }
    void add_velocity(int row, int group, const V& change) const noexcept {
        (velocity(row, group) + change).copy_to(sweep_.velocity->at(row, column(group)));
    }

    /// Adds a force across the axis and along it at point g.
    void add_point(int group, int g, const V& across, const V& along, V* force) const noexcept {
        const int row = field_.components.joint(g);
        const V x = -(contact(row + Joint::normal_y, group) * across), y = contact(row + Joint::normal_x, group) * across;
        force[0] += x;
        force[n] += y;
        for (int m = 1; m < n; ++m) {
            force[m] += basis(m, g) * x;
            force[n + m] += basis(m, g) * y;
        }
        force[2 * n] += along;
        force[2 * n + 1] += numbers_.joint_position[static_cast<std::size_t>(g)] * along;
        force[2 * n + 2] += across * contact(row + Joint::lever_before, group);
        force[2 * n + 3] += across * contact(row + Joint::lever_after, group);
    }

    void open_point(int group, int g, V* force) const noexcept {
        const V friction_limit = contact(field_.components.joint(g) + Joint::friction_limit, group);
        const V across = before(rows_.opening(rows_.joint(g)), group), along = before(rows_.opening(rows_.joint(g) + 1), group);
        put(rows_.joint(g), group, across);
        put(rows_.joint(g) + 1, group, along);
        put(rows_.joint_speed(g), group, before(rows_.joint_speed(g), group));
        add_point(group, g, friction_limit * across, friction_limit * along, force);
    }

    /// Force at point g for the sliding that all others leave it (…_without, its own friction taken away; own_… is the sliding that its
    /// full friction takes away); adds its change to `force` and the response to it to the rates.
    void solve_point(int group, int g, JointRates& rates, V* force) const noexcept {
        const auto at_g = static_cast<std::size_t>(g);
        const int row = rows_.joint(g), contacts = field_.components.joint(g);
        const V friction_limit = contact(contacts + Joint::friction_limit, group);
        const V across = kept_row(row, group), along = kept_row(row + 1, group);
        const V own_across = responses_.joint_across[at_g] * friction_limit, own_along = responses_.joint_along[at_g] * friction_limit;
        const V across_without = slip_across(group, g, rates) - own_across * across;
        const V along_without = rates.z + numbers_.joint_position[at_g] * rates.e - own_along * along;
        const V speed = sliding_speed(group, g, {across_without, along_without}, {own_across, own_along});
        const Reciprocals<W> inverse(speed + own_across, speed + own_along);
        const V new_across = -(across_without * inverse.first), new_along = -(along_without * inverse.second);
        put(row, group, new_across);
        put(row + 1, group, new_along);
        const V change = friction_limit * (new_across - across), push = friction_limit * (new_along - along);
        add_point(group, g, change, push, force);
        const V x = -(contact(contacts + Joint::normal_y, group) * change), y = contact(contacts + Joint::normal_x, group) * change;
        for (int m = 0; m < n; ++m) {
            rates.x[m] += responses_.joint_lateral[at_g][static_cast<std::size_t>(m)] * x;
            rates.y[m] += responses_.joint_lateral[at_g][static_cast<std::size_t>(m)] * y;
        }
        rates.z += responses_.joint_shift * push;
        rates.e += responses_.joint_tilt[at_g] * push;
    }

    /// The speed D ≥ v0 that a point slides with, or v0: Σ (without/(D + own_slip))² = 1, one step of Newton's method from the last one on.
    [[nodiscard]] V sliding_speed(int group, int g, const V (&without)[2], const V (&own_slip)[2]) const noexcept {
        const V slowest(numbers_.joint.saturation_speed);
        const V from = larger<W>(kept_row(rows_.joint_speed(g), group), slowest);
        const Reciprocals<W> inverse(from + own_slip[0], from + own_slip[1]);
        const V across = without[0] * inverse.first, along = without[1] * inverse.second;
        const V a = across * across, b = along * along, sum = a + b;
        const V slope = a * inverse.first + b * inverse.second + V(1e-20);
        const V speed = larger<W>(from + sum * (sqrt(sum) - V(1.0)) / slope, slowest);
        put(rows_.joint_speed(g), group, speed);
        return speed;
    }

    /// Forces of plates and tips of the step before.
    void open_link(int group, bool touch, V* f, V& moment) const noexcept {
        for (int k = 0; k < 2; ++k) {
            const V force = before(rows_.opening(rows_.plates() + k), group);
            put(rows_.plates() + k, group, force);
            put(rows_.plate_rate() + k, group, before(rows_.plate_rate() + k, group));
            f[link_layout.z(End::front) + k] += force;
            f[link_layout.z(End::rear) + k] = f[link_layout.z(End::rear) + k] - force;
        }
        for (int row = rows_.tip(0); row < rows_.forces(); ++row) put(row, group, touch ? before(rows_.opening(row), group) : V(0.0));
        if (!touch) return;
        for (const End end : {End::rear, End::front}) {
            const int low = 2 * static_cast<int>(end);
            const AtTips<V> forces{tip_force(group, low), tip_force(group, low + 1)};
            add_tips(group, end, forces, f, moment);
        }
    }

    void add_tips(int group, End end, const AtTips<V>& forces, V* f, V& moment) const noexcept {
        const int low = 2 * static_cast<int>(end);
        FrictionTips<W, false>::spread(forces, {link_layout.x(end, 0), link_layout.y(end, 0), link_layout.z(end)}, f);
        for (const auto& [force, corner] : {std::pair{&forces.low, low}, std::pair{&forces.high, low + 1}}) {
            const int row = field_.components.tip(corner);
            moment += contact(row + Tip::lever_x, group) * force->y - contact(row + Tip::lever_y, group) * force->x;
        }
    }

    /// A⁻¹ f.
    void respond(int group, const V* f, V* accelerations) const noexcept {
        const V tx = contact(ContactComponents::frame_x, group), ty = contact(ContactComponents::frame_y, group);
        multiply_turned(numbers_.along, numbers_.across, tx, ty, f, accelerations);
        multiply_ends<2>(numbers_.axial, f + 4 * n, accelerations + 4 * n);
    }

    /// Velocities after forces have acted over the step. @param to velocities so far, or the result
    void accelerate(int group, const V* f, FloatColumns& to) const noexcept {
        V change[link_layout.link_size()];
        respond(group, f, change);
        for (int row = 0; row < link_layout.link_size(); ++row) {
            V v = velocity(row, group);
            if (sweep_.part == SweepPart::opening)
                v = load<W>(sweep_.start->at(row, column(group))) + responses_.step * load<W>(sweep_.base->at(row, column(group)));
            (v + responses_.step * change[row]).copy_to(to.at(row, column(group)));
        }
    }

    /// Plates with the secants of the last rates: two equations for the sliding of both directions.
    void solve_plates(int group) const noexcept {
        const V force_z = kept_row(rows_.plates(), group), force_e = kept_row(rows_.plates() + 1, group);
        V a(0.0), b(0.0), e(0.0);
        add_secants(group, a, b, e);
        const auto [rate_z, rate_e] = Base::plate_rates(group);
        const V z_without = rate_z - responses_.plate_shift * force_z, e_without = rate_e - responses_.plate_tilt * force_e;
        const V zz = V(1.0) + responses_.plate_shift * a, ze = responses_.plate_shift * b, ez = responses_.plate_tilt * b,
                ee = V(1.0) + responses_.plate_tilt * e;
        const V inverse = V(1.0) / (zz * ee - ze * ez);
        const V z = (z_without * ee - ze * e_without) * inverse, tilt = (zz * e_without - ez * z_without) * inverse;
        const V new_z = -(a * z + b * tilt), new_e = -(b * z + e * tilt);
        put(rows_.plate_rate(), group, z);
        put(rows_.plate_rate() + 1, group, tilt);
        put(rows_.plates(), group, new_z);
        put(rows_.plates() + 1, group, new_e);
        const V shift = responses_.link_shift * (new_z - force_z), turn = responses_.link_tilt * (new_e - force_e);
        add_velocity(link_layout.z(End::front), group, shift);
        add_velocity(link_layout.z(End::rear), group, -shift);
        add_velocity(link_layout.e(End::front), group, turn);
        add_velocity(link_layout.e(End::rear), group, -turn);
    }

    /// Σ secant, Σ ξ secant, Σ ξ² secant.
    void add_secants(int group, V& a, V& b, V& e) const noexcept {
        const V z = kept_row(rows_.plate_rate(), group), tilt = kept_row(rows_.plate_rate() + 1, group),
                slowest(numbers_.plate.saturation_speed);
        const auto add = [&](int plate, const V& inverse_speed) {
            const float xi = numbers_.plate_position[static_cast<std::size_t>(plate)];
            const V secant = contact(field_.components.plate(plate), group) * inverse_speed, lever = xi * secant;
            a += secant;
            b += lever;
            e += xi * lever;
        };
        const auto speed = [&](int plate) {
            return larger<W>(abs(z + numbers_.plate_position[static_cast<std::size_t>(plate)] * tilt), slowest);
        };
        int plate = 0;
        for (; plate + 1 < field_.components.plates; plate += 2) {
            const Reciprocals<W> inverse(speed(plate), speed(plate + 1));
            add(plate, inverse.first);
            add(plate + 1, inverse.second);
        }
        if (plate < field_.components.plates) add(plate, V(1.0) / speed(plate));
    }

    /// All tips at the velocities that they have left each other so far.
    void solve_tips(int group) const noexcept {
        V f[link_layout.link_size()];
        for (V& row : f) row = V(0.0);
        V moment(0.0);
        const V turn = Base::turning(group);
        for (const End end : {End::rear, End::front}) {
            const int low = 2 * static_cast<int>(end);
            const AtTips<V> velocities = Base::tip_velocities(group, {link_layout.x(end, 0), link_layout.y(end, 0), link_layout.z(end)});
            const AtTips<V> changes{solve_tip(group, low, velocities.low, turn), solve_tip(group, low + 1, velocities.high, turn)};
            add_tips(group, end, changes, f, moment);
        }
        add_couple(group, moment, f);
        V change[link_layout.link_size()];
        respond(group, f, change);
        for (int row = 0; row < link_layout.link_size(); ++row) add_velocity(row, group, responses_.step * change[row]);
    }

    /// With the slip u that would be there without this tip's friction, c the limit and r the response, friction is -c u/(max(|u| - r c,
    /// v0) + r c) times the law's factor.
    /// @return change of its force
    [[nodiscard]] AtTip<V> solve_tip(int group, int corner, const AtTip<V>& v, const V& turn) const noexcept {
        const V friction_limit = contact(field_.components.tip(corner) + Tip::friction_limit, group),
                own_slip = responses_.tip * friction_limit;
        const AtTip<V> old = tip_force(group, corner);
        const AtTip<V> without =
            slip(group, corner, {v.x - responses_.tip * old.x, v.y - responses_.tip * old.y, v.z - responses_.tip * old.z}, turn);
        const V speed = sqrt(without.square()), lawful = lawful_share(own_slip, speed), lawful_slip = lawful * own_slip;
        const V factor = -(lawful / (lawful_slip + tip_speed(group, corner, speed - lawful_slip)));
        const V none(0.0);
        const auto held = [&](const V& sliding) { return select_greater<W>(friction_limit, none, factor * sliding, none); };
        const AtTip<V> part{held(without.x), held(without.y), held(without.z)};
        const V tx = contact(ContactComponents::frame_x, group), ty = contact(ContactComponents::frame_y, group);
        put(rows_.tip(corner), group, part.x * tx + part.y * ty);
        put(rows_.tip(corner) + 1, group, part.y * tx - part.x * ty);
        put(rows_.tip(corner) + 2, group, part.z);
        const V forces[3] = {friction_limit * part.x, friction_limit * part.y, friction_limit * part.z};
        for (int axis = 0; axis < 3; ++axis) forces[axis].copy_to(sweep_.mean_tip_forces->at(3 * corner + axis, column(group)));
        return {forces[0] - old.x, forces[1] - old.y, forces[2] - old.z};
    }

    /// Factor of the tips' law at the sliding speed that friction leaves. @param own_slip sliding that its full friction takes away [m/s]
    [[nodiscard]] V lawful_share(const V& own_slip, const V& speed) const noexcept {
        if (numbers_.tip_law == nullptr) return V(1.0);
        return speed_factor<W>(*numbers_.tip_law, braked_speed<W>(*numbers_.tip_law, own_slip, speed, V(numbers_.tip.saturation_speed)));
    }

    /// Sliding speed within the branch of the law that holds.
    [[nodiscard]] V tip_speed(int group, int corner, const V& sliding) const noexcept {
        if (!Base::friction_.by_phase()) return larger<W>(sliding, V(numbers_.tip.saturation_speed));
        return Base::within_branch(group, corner, sliding);
    }

    /// Keeps the forces with which the next step begins.
    void keep_opening(int group) const noexcept {
        for (int row = 0; row < rows_.forces(); ++row) {
            const V now = kept_row(row, group);
            put(rows_.opening(row), group, now + sweep_.ahead * (now - before(row, group)));
        }
    }

    const FrictionSweep& sweep_;
    const SweepResponses& responses_;
};

/// A pass over the links of a range: their joints, then the links.
inline void sweep_links(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range,
                        const FrictionSweep& sweep) noexcept {
    const int links = range.last - range.first;
    over_groups(0, links + 1, [&]<int W>(int group) { SweepLanes<W>(friction, field, range, sweep).joints(group); });
    over_groups(0, links, [&]<int W>(int group) { SweepLanes<W>(friction, field, range, sweep).links(group); });
}

}  // namespace
}  // namespace cvtflow::model
