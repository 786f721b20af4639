#pragma once
/// Friction of all contacts as a function of velocities, for tables of stages: its slope, and the row of a table that takes it, lanes over
/// links. (model/EQUATIONS.md sections 4 to 7)

#include "model/contact/contact_lanes.hpp"
#include "model/contact/friction_stage.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {
namespace {

/// Friction of the joints of the rear pins of W links. Points at ξ and -ξ are taken together.
template <int W>
class JointStage {
public:
    using V = Lanes<W>;
    using Joints = JointContacts<W>;

    JointStage(const FrictionOperator& friction, const LinkLanes<W>& links) noexcept : joints_{links, friction.numbers()} {}

    void run() const noexcept {
        const Rates rates = joints_.rates();
        V force[Joints::rows];
        for (V& row : force) row = V(0.0);
        const int points = joints_.points();
        for (int g = 0; g < points / 2; ++g) mirrored_points(g, rates, force);
        if (points % 2 == 1) middle_point(points / 2, rates, force);
        JointForces<W>(joints_.links.range).put(joints_.links.group, force);
    }

private:
    using Joint = ContactComponents::Joint;
    using Rates = typename Joints::Rates;
    static constexpr int n = axis_terms;
    static_assert(n == 4);

    /// Legendre modes of even and of odd order summed apart, so that they serve the points at ξ and at -ξ.
    struct Halves {
        V even, odd;
    };
    struct PointForce {
        V x, y, along;
    };

    [[nodiscard]] Halves halves_at(const V* modes, int g) const noexcept {
        return {modes[0] + joints_.basis(2, g) * modes[2], joints_.basis(1, g) * modes[1] + joints_.basis(3, g) * modes[3]};
    }

    /// Force at point g that slides with slip and axial; moments to force.
    [[nodiscard]] PointForce point_force(int g, const V& slip, const V& axial, const V& factor, V* force) const noexcept {
        const V friction_per_speed = joints_.contact(g, Joint::friction_limit) * factor;
        const V across = friction_per_speed * slip;  // against the motion: signs below
        force[Joints::moment_before] = force[Joints::moment_before] - across * joints_.contact(g, Joint::lever_before);
        force[Joints::moment_after] = force[Joints::moment_after] - across * joints_.contact(g, Joint::lever_after);
        return {across * joints_.contact(g, Joint::normal_y), -(across * joints_.contact(g, Joint::normal_x)),
                -(friction_per_speed * axial)};
    }

    /// Points g and count - 1 - g, at ξ and -ξ.
    void mirrored_points(int g, const Rates& rates, V* force) const noexcept {
        const int h = joints_.points() - 1 - g;
        const float xi = joints_.position(g);
        const Halves x = halves_at(rates.x, g), y = halves_at(rates.y, g);
        const V slip_g = joints_.slip(g, x.even + x.odd, y.even + y.odd, rates),
                slip_h = joints_.slip(h, x.even - x.odd, y.even - y.odd, rates);
        const V tilt = xi * rates.e;
        const V axial_g = rates.z + tilt, axial_h = rates.z - tilt;
        const auto [factor_g, factor_h] =
            slip_factors_of_squares<W>(joints_.numbers.joint, slip_g * slip_g + axial_g * axial_g, slip_h * slip_h + axial_h * axial_h);
        const PointForce a = point_force(g, slip_g, axial_g, factor_g, force), b = point_force(h, slip_h, axial_h, factor_h, force);
        spread(g, a.x + b.x, a.x - b.x, force);
        spread(g, a.y + b.y, a.y - b.y, force + n);
        force[Joints::z] += a.along + b.along;
        force[Joints::e] += xi * (a.along - b.along);
    }

    /// The point at ξ = 0.
    void middle_point(int g, const Rates& rates, V* force) const noexcept {
        const V slip = joints_.slip(g, halves_at(rates.x, g).even, halves_at(rates.y, g).even, rates);
        const V factor = slip_factor_of_square<W>(joints_.numbers.joint, slip * slip + rates.z * rates.z);
        const PointForce f = point_force(g, slip, rates.z, factor, force);
        spread(g, f.x, V(0.0), force);
        spread(g, f.y, V(0.0), force + n);
        force[Joints::z] += f.along;
    }

    /// Adds the forces at two mirrored points, as sum and difference, to the modes.
    void spread(int g, const V& sum, const V& difference, V* modes) const noexcept {
        modes[0] += sum;
        modes[1] += joints_.basis(1, g) * difference;
        modes[2] += joints_.basis(2, g) * sum;
        modes[3] += joints_.basis(3, g) * difference;
    }

    const Joints joints_;
};

/// Friction of the plates and tips of W links, whose joints must be in scratch, and what the stage makes of the slope.
template <int W>
class LinkStage {
public:
    using V = Lanes<W>;

    LinkStage(const FrictionOperator& friction, const LinkLanes<W>& links, const FrictionStage& stage) noexcept
        : friction_(friction), numbers_(friction.numbers()), links_(links), tips_{links}, stage_(stage) {}

    void run() const noexcept {
        const JointForces<W> joints(links_.range);
        V f[link_layout.link_size()];
        joints.act(links_.group, f);
        V moment = joints.moment(links_.group);
        plates(f);
        if (links_.touch()) tips(f, moment);
        links_.add_couple(moment, f);
        accelerate(f);
    }

private:
    using Tip = ContactComponents::Tip;
    static constexpr int n = axis_terms;

    void plates(V* f) const noexcept {
        const auto [gap_z, gap_e] = links_.plate_rates();
        const ContactComponents& components = links_.field.components;
        V fz(0.0), fe(0.0);
        for (int j = 0; j < components.plates; ++j) {
            const float xi = numbers_.plates.position[static_cast<std::size_t>(j)];
            const V sliding = gap_z + xi * gap_e;
            const V slide = links_.contact[components.plate(j)] * friction_share<W>(numbers_.plate, sliding);
            fz += slide;
            fe += xi * slide;
        }
        f[link_layout.z(End::front)] = f[link_layout.z(End::front)] - fz;
        f[link_layout.e(End::front)] = f[link_layout.e(End::front)] - fe;
        f[link_layout.z(End::rear)] += fz;
        f[link_layout.e(End::rear)] += fe;
    }

    void tips(V* f, V& moment) const noexcept {
        const V turn = links_.turning();
        for (const End end : {End::rear, End::front}) {
            const int low = 2 * static_cast<int>(end);
            const AtTips<V> velocities = tips_.velocities(end);
            const AtTip<V> a = tips_.slip(low, velocities.low, turn), b = tips_.slip(low + 1, velocities.high, turn);
            const auto [factor_a, factor_b] = factors(low, a.square(), b.square());
            const AtTips<V> forces{force(low, a, factor_a), force(low + 1, b, factor_b)};
            add_means(low, forces);
            tips_.act(end, forces, f, moment);
        }
    }

    [[nodiscard]] AtTip<V> force(int corner, const AtTip<V>& slip, const V& factor) const noexcept {
        const V friction_per_speed = -tips_.contact(corner, Tip::friction_limit) * factor;
        return {friction_per_speed * slip.x, friction_per_speed * slip.y, friction_per_speed * slip.z};
    }

    /// Factors of tips `low` and low + 1, whose slips have these squares.
    [[nodiscard]] std::pair<V, V> factors(int low, const V& first, const V& second) const noexcept {
        const auto [a, b] = plain_factors(low, first, second);
        if (numbers_.tip_law == nullptr) return {a, b};
        const TipLaw& law = *numbers_.tip_law;
        return {a * speed_factor_of_square<W>(law, first), b * speed_factor_of_square<W>(law, second)};
    }

    /// Factors without the tips' law by speed, which makes them no larger.
    [[nodiscard]] std::pair<V, V> plain_factors(int low, const V& first, const V& second) const noexcept {
        if (!friction_.by_phase()) return slip_factors_of_squares<W>(numbers_.tip, first, second);
        return {1.0 / tips_.within_branch(low, sqrt(first)), 1.0 / tips_.within_branch(low + 1, sqrt(second))};
    }

    /// Adds forces to the means of tips `low` and low + 1, if those are requested.
    void add_means(int low, const AtTips<V>& tips) const noexcept {
        if (stage_.mean_tip_forces == nullptr) return;
        const auto weight = static_cast<float>(stage_.weight);
        int row = 3 * low;
        for (const AtTip<V>* tip : {&tips.low, &tips.high})
            for (const V* force : {&tip->x, &tip->y, &tip->z}) add_mean(row++, weight * *force);
    }

    /// Adds to a row of the range's links; columns beside them are others'.
    void add_mean(int row, const V& force) const noexcept {
        float* to = stage_.mean_tip_forces->at(row, links_.column());
        const int count = links_.count();
        if (count == lane_count<W>) return (load<W>(to) + force).copy_to(to);
        float sum[static_cast<std::size_t>(lane_count<W>)] = {};
        std::copy_n(to, count, sum);
        store_first<W>(load<W>(sum) + force, to, count);
    }

    using Rows = std::array<V, link_layout.link_size()>;

    /// Accelerations of links that are not held by forces: slopes alone, or the row of a table that takes them.
    void accelerate(const V* f) const noexcept {
        Rows slope;
        for (int axis = 0; axis < 2; ++axis) multiply_ends<n>(numbers_.inverse.across, f + 2 * n * axis, slope.data() + 2 * n * axis);
        multiply_ends<2>(numbers_.inverse.axial, f + 4 * n, slope.data() + 4 * n);
        if (stage_.next != nullptr) add_base(slope);
        if (stage_.slope != nullptr) store(*stage_.slope, slope);
        if (stage_.next != nullptr) combine(*stage_.next, slope);
    }
    void add_base(Rows& slope) const noexcept {
        const auto now = links_.rows_of(*stage_.base->now), before = links_.rows_of(*stage_.base->before);
        const V extrapolation(static_cast<float>(stage_.base->extrapolation));
        for (std::size_t row = 0; row < slope.size(); ++row) {
            const V here = now[static_cast<int>(row)];
            slope[row] += here + extrapolation * (here - before[static_cast<int>(row)]);
        }
    }
    /// Row by row in the order of the terms, so that sums round alike however many there are.
    void combine(const VelocityRow& next, const Rows& slope) const noexcept {
        Rows sum;
        for (std::size_t k = 0; k < next.terms; ++k) {
            const auto from = links_.rows_of(*next.from[k]);
            const V weight(static_cast<float>(next.weight[k]));
            for (std::size_t row = 0; row < sum.size(); ++row) {
                const V term = weight * from[static_cast<int>(row)];
                sum[row] = k == 0 ? term : sum[row] + term;
            }
        }
        const V weight(static_cast<float>(next.slope_weight));
        for (std::size_t row = 0; row < sum.size(); ++row) sum[row] += weight * slope[row];
        store(*next.to, sum);
    }
    void store(FloatColumns& columns, const Rows& lanes) const noexcept {
        const LaneRows<W, float> to = links_.rows_of(columns);
        const int count = links_.count();
        for (std::size_t row = 0; row < lanes.size() && count == lane_count<W>; ++row) to.put(static_cast<int>(row), lanes[row]);
        for (std::size_t row = 0; row < lanes.size() && count != lane_count<W>; ++row)
            store_first<W>(lanes[row], to.first + static_cast<std::ptrdiff_t>(row) * to.stride, count);
    }

    const FrictionOperator& friction_;
    const FrictionNumbers& numbers_;
    const LinkLanes<W> links_;
    const TipContacts<W> tips_;
    const FrictionStage& stage_;
};

/// Slopes of the links of a range: their joints, then the links.
inline void evaluate_links(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range,
                           const FrictionStage& stage) noexcept {
    const int links = range.last - range.first;
    over_groups(0, links + 1, [&]<int W>(int group) { JointStage<W>(friction, {field, range, group}).run(); });
    over_groups(0, links, [&]<int W>(int group) { LinkStage<W>(friction, {field, range, group}, stage).run(); });
}

}  // namespace
}  // namespace cvtflow::model
