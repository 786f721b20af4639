#pragma once
/// The forces that implicit sweeps have found (model/contact/sweep_step.hpp) and what they dissipate, lanes over links.

#include "model/contact/friction_lanes.hpp"
#include "model/contact/sweep_step.hpp"

namespace cvtflow::model {
namespace {

/// W links side by side; column numbers count from the first link of the range.
template <int P, int W>
class SweepForces : protected FrictionLanes<P, W, false> {
    using Base = FrictionLanes<P, W, false>;

public:
    using typename Base::Number, typename Base::V;

    /// @param kept_forces [SweepRows::count()] rows
    SweepForces(const FrictionOperator& friction, const ContactFieldOf<Number>& field, const FrictionRangeOf<Number>& range,
                const ColumnsOf<Number>& kept_forces) noexcept
        : Base(friction, field, range), rows_{field.components.joint_points}, kept_forces_(kept_forces) {}

    /// Of links first + own … + W - 1, at the velocities of the range. powers [links of the range]
    void powers(int own, FrictionPowers* powers) const noexcept {
        const int lanes = Base::links_at(own);
        Number of_kind[3][static_cast<std::size_t>(lane_count<W>)];
        joint_power(own).copy_to(of_kind[0]);
        plate_power(own).copy_to(of_kind[1]);
        tip_power(own).copy_to(of_kind[2]);  // a tip may have lifted at the step's end
        for (int lane = 0; lane < lanes; ++lane) powers[own + lane] = {of_kind[0][lane], of_kind[1][lane], of_kind[2][lane]};
    }

protected:
    using Base::basis, Base::contact, Base::column, Base::numbers_, Base::field_, Base::kept, Base::keep, Base::velocity, Base::slip,
        Base::n;
    using typename Base::Joint, typename Base::Tip, typename Base::JointRates;

    [[nodiscard]] V share(int row, int own) const noexcept { return load<W>(kept_forces_.at(row, column(own))); }

    /// Sliding of point g across the axis, at rates that other points have changed.
    [[nodiscard]] V slip_across(int own, int g, const JointRates& rates) const noexcept {
        V x = rates.x[0], y = rates.y[0];
        for (int m = 1; m < n; ++m) {
            x += basis(m, g) * rates.x[m];
            y += basis(m, g) * rates.y[m];
        }
        return Base::slip_of(own, g, x, y, rates);
    }

    /// Of a kept share; shares turn with the link.
    [[nodiscard]] AtTip<V> tip_force(int own, int corner) const noexcept {
        const int row = rows_.tip(corner);
        const V friction_limit = contact(field_.components.tip(corner) + Tip::friction_limit, own);
        const V tx = contact(ContactComponents::frame_x, own), ty = contact(ContactComponents::frame_y, own);
        const V along = share(row, own), across = share(row + 1, own);
        return {friction_limit * (along * tx - across * ty), friction_limit * (along * ty + across * tx),
                friction_limit * share(row + 2, own)};
    }

    const SweepRows rows_;

private:
    [[nodiscard]] V joint_power(int own) const noexcept {
        const JointRates rates = Base::joint_rates(own);
        V sum(0.0);
        for (int g = 0; g < rows_.joint_points; ++g) {
            const V along = rates.z + numbers_.joint_position[static_cast<std::size_t>(g)] * rates.e;
            sum += contact(field_.components.joint(g) + Joint::friction_limit, own) *
                   (share(rows_.joint(g), own) * slip_across(own, g, rates) + share(rows_.joint(g) + 1, own) * along);
        }
        return -sum;
    }

    [[nodiscard]] V plate_power(int own) const noexcept {
        const auto [z, e] = Base::plate_rates(own);
        return -(share(rows_.plates(), own) * z + share(rows_.plates() + 1, own) * e);
    }

    [[nodiscard]] V tip_power(int own) const noexcept {
        const V turn = Base::turning(own);
        V sum(0.0);
        for (const End end : {End::rear, End::front}) {
            const int low = 2 * static_cast<int>(end);
            const AtTips<V> v = Base::tip_velocities(own, {at<P>.x(end, 0), at<P>.y(end, 0), at<P>.z(end)});
            for (const auto& [velocity, corner] : {std::pair{&v.low, low}, std::pair{&v.high, low + 1}}) {
                const AtTip<V> slip = Base::slip(own, corner, *velocity, turn), force = tip_force(own, corner);
                sum += force.x * slip.x + force.y * slip.y + force.z * slip.z;
            }
        }
        return -sum;
    }

    const ColumnsOf<Number>& kept_forces_;
};

template <class Number, int P>
void sweep_powers(const FrictionOperator& friction, const ContactFieldOf<Number>& field, const FrictionRangeOf<Number>& range,
                  const ColumnsOf<Number>& kept, FrictionPowers* powers) noexcept {
    over_groups<Number>(0, range.last - range.first,
                        [&]<int W>(int own) { SweepForces<P, W>(friction, field, range, kept).powers(own, powers); });
}

}  // namespace
}  // namespace cvtflow::model
