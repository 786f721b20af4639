#include <algorithm>
#include <cmath>
#include <limits>

#include "model/contact/friction_lanes.hpp"
#include "model/kernels/chain_parts.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/lanes/lane_pass.hpp"

namespace cvtflow::model {

namespace {

using Joint = ContactComponents::Joint;
using Tip = ContactComponents::Tip;

/// One link's column of a field, while it is written.
class Column {
public:
    Column(ContactField& field, int column) noexcept : field_(field), column_(column) {}
    double& operator[](int component) const noexcept { return *field_.columns.at(component, column_); }
    void repeat_at(int column) const noexcept {
        for (int k = 0; k < field_.components.count(); ++k) *field_.columns.at(k, column) = *field_.columns.at(k, column_);
    }

private:
    ContactField& field_;
    int column_;
};

/// Elastic and damping tension of W plates [N].
template <int P, int W>
[[nodiscard]] Lanes<W> plate_tension(const Coefficients& c, double free_length, const AxisPoints<P, W>& points, const Difference<P>& d,
                                     const Difference<P>& rate, int first) noexcept {
    const Lanes<W> dx = points.along(d.x), dy = points.along(d.y), dz = d.z + points.xi * d.e;
    const Lanes<W> vx = points.along(rate.x), vy = points.along(rate.y), vz = rate.z + points.xi * rate.e;
    const Lanes<W> length = sqrt(dx * dx + dy * dy + dz * dz);
    const Lanes<W> stretching = (dx * vx + dy * vy + dz * vz) / length;
    return load<W>(&c.plates.weight[static_cast<std::size_t>(first)]) * (length - free_length) +
           load<W>(&c.plates.damping[static_cast<std::size_t>(first)]) * stretching;
}

template <int P>
class Recorder {
public:
    Recorder(const ChainModel& chain, const ChainRange& range, const ContactDrift& drift, ContactField& field) noexcept
        : chain_(chain), c_(chain.coefficients()), range_(range), drift_(drift), field_(field) {}

    void link(int link, LinkLoad& load) const noexcept {
        const Column column(field_, link + 1);
        const LinkFrame here = frame(link);
        column[ContactComponents::frame_x] = here.tx;
        column[ContactComponents::frame_y] = here.ty;
        column[ContactComponents::inverse_length] = here.inverse_length;
        joint(link, here, column);
        plates(link, column);
        tips(link, here, column, load);
        const int links = chain_.layout().links;
        if (link == 0) column.repeat_at(links + 1);
        if (link == links - 1) column.repeat_at(0);
    }

private:
    [[nodiscard]] const double* state(int link) const noexcept { return range_.window + (link - range_.first + 1) * at<P>.link_block(); }
    [[nodiscard]] const double* velocity(int link) const noexcept { return state(link) + at<P>.link_size(); }
    [[nodiscard]] LinkFrame frame(int link) const noexcept { return link_frame<P>(state(link), velocity(link)); }

    // No sums over lanes here: as many points and plates at a time as the processor's vectors hold.
    static constexpr int W = native_lanes;

    void joint(int link, const LinkFrame& here, const Column& column) const noexcept {
        const JointFrames<double> frames(frame(link - 1), here);
        const Difference<P> gap(state(link - 1), End::front, state(link), End::rear),
            rate(velocity(link - 1), End::front, velocity(link), End::rear);
        for (int first = 0; first < c_.joint_points.count; first += W) joint_points(first, frames, gap, rate, column);
    }

    void joint_points(int first, const JointFrames<double>& frames, const Difference<P>& gap, const Difference<P>& rate,
                      const Column& column) const noexcept {
        const AxisPoints<P, W> points(c_.joint_points, first);
        const auto m = joint_motion<P, W>(c_.joint, frames, points, gap, rate);
        const Lanes<W> weight = load<W>(&c_.joint_points.weight[static_cast<std::size_t>(first)]);
        const Lanes<W> normal = normal_force<W>(c_.joint, weight, m).normal;
        for (int g = first; g < std::min(first + W, c_.joint_points.count); ++g) {
            const int row = field_.components.joint(g);
            const auto lane = static_cast<std::size_t>(g - first);
            column[row + Joint::normal_x] = m.nx[lane];
            column[row + Joint::normal_y] = m.ny[lane];
            column[row + Joint::lever_before] = m.lever_before[lane];
            column[row + Joint::lever_after] = m.lever_after[lane];
            column[row + Joint::grip] = c_.joint.friction.coefficient * normal[lane];
        }
    }

    void plates(int link, const Column& column) const noexcept {
        const Difference<P> d(state(link), End::front, state(link), End::rear);
        const Difference<P> rate(velocity(link), End::front, velocity(link), End::rear);
        for (int first = 0; first < c_.plates.count; first += W) {
            const AxisPoints<P, W> points(c_.plates, first);
            alignas(64) double tension[W];
            plate_tension<P, W>(c_, c_.kind(link).free_length, points, d, rate, first).copy_to(tension);
            for (int j = first; j < std::min(first + W, c_.plates.count); ++j) {
                column[field_.components.plate(j)] = c_.plate_friction.coefficient * std::max(0.0, tension[j - first]);
            }
        }
    }

    void tips(int link, const LinkFrame& here, const Column& column, LinkLoad& load) const noexcept {
        const Phase* phases = range_.phases + tips_per_link * link;
        for (int corner = 0; corner < tips_per_link; ++corner) column[field_.components.tip(corner) + Tip::grip] = 0.0;
        if (!any_touching(phases)) return;
        load.shaft = chain_.shaft_of(state(link));
        const SheaveMotion* sheaves = range_.sheaves + 2 * load.shaft;
        const FourTips four;
        const auto sheave = sheaves_at(four, sheaves);
        const auto geometry = tip_geometry<P>(c_, four, here, state(link), sheave);
        const auto motion = tip_motion<P>(c_, four, here, velocity(link), sheave, geometry);
        auto forces = tip_forces<false, tips_per_link>(c_.tip, geometry, motion, touching_lanes(phases), phases_of_link(phases), nullptr);
        forces.friction = {TipLanes(0.0), TipLanes(0.0), TipLanes(0.0)};
        load.load = load_sheaves(geometry, motion, forces);
        for (int corner = 0; corner < tips_per_link; ++corner) {
            tip(link, corner, geometry, motion, forces, phases[corner], column);
            drift(corner, sheaves[corner % 2], drift_.change[2 * load.shaft + corner % 2], field_.arms[static_cast<std::size_t>(link)],
                  column);
        }
    }

    void tip(int link, int corner, const TipGeometry<P, TipLanes>& g, const TipMotion<TipLanes>& m, const TipForces<TipLanes>& forces,
             Phase phase, const Column& column) const noexcept {
        const auto lane = static_cast<std::size_t>(corner);
        const int row = field_.components.tip(corner);
        const double px = m.sheave_arm.x[lane], py = m.sheave_arm.y[lane], pz = m.sheave_arm.z[lane];
        column[row + Tip::normal] = g.normal.x[lane];
        column[row + Tip::normal + 1] = g.normal.y[lane];
        column[row + Tip::normal + 2] = g.normal.z[lane];
        column[row + Tip::lever_x] = m.lever_x[lane];
        column[row + Tip::lever_y] = m.lever_y[lane];
        column[row + Tip::grip] = c_.tip.friction.coefficient * forces.normal[lane];
        const double v0 = c_.tip.friction.saturation_speed;
        column[row + Tip::least] = phase == Phase::slip ? std::numeric_limits<double>::min() : v0;
        column[row + Tip::most] = phase == Phase::stick ? v0 : std::numeric_limits<double>::max();
        TipArms& arms = field_.arms[static_cast<std::size_t>(link)];
        arms.x[corner] = px;
        arms.y[corner] = py;
        arms.z[corner] = pz;
    }

    /// Velocity of the sheave at a tip's contact, and how it changes over the step while both go round.
    void drift(int corner, const SheaveMotion& s, const SheaveMotion& change, const TipArms& p, const Column& column) const noexcept {
        const int row = field_.components.tip(corner);
        const double px = p.x[corner], py = p.y[corner], pz = p.z[corner];
        const double x = s.spin_y * pz - s.spin_z * py, y = s.spin_z * px - s.spin_x * pz, z = s.spin_x * py - s.spin_y * px;
        column[row + Tip::sheave] = s.vx + x;
        column[row + Tip::sheave + 1] = s.vy + y;
        column[row + Tip::sheave + 2] = s.vz + z;
        const double h = drift_.step;
        column[row + Tip::drift] = change.vx + change.spin_y * pz - change.spin_z * py + h * (s.spin_y * z - s.spin_z * y);
        column[row + Tip::drift + 1] = change.vy + change.spin_z * px - change.spin_x * pz + h * (s.spin_z * x - s.spin_x * z);
        column[row + Tip::drift + 2] = change.vz + change.spin_x * py - change.spin_y * px + h * (s.spin_x * y - s.spin_y * x);
    }

    const ChainModel& chain_;
    const Coefficients& c_;
    const ChainRange& range_;
    const ContactDrift& drift_;
    ContactField& field_;
};

template <int P>
void record(const ChainModel& chain, const ChainRange& range, const ContactDrift& drift, ContactField& field, LinkLoad* loads) noexcept {
    const Recorder<P> recorder(chain, range, drift, field);
    for (int link = range.first; link < range.last; ++link) recorder.link(link, loads[link - range.first]);
}

template <int P>
void push(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, ContactField& field, Columns& push,
          LinkLoad* loads) noexcept {
    const ChainModel& chain = friction.chain();
    using Contacts = ContactWriter<P, native_lanes>;
    const Contacts contacts(chain.coefficients(), range, drift, friction.by_phase(), field, push);
    LanePass<P, native_lanes, Contacts>(chain, friction.frictionless(), range, loads, contacts).run();
    contacts.repeat(chain.layout().links);
}

template <int P, bool Steepest>
void evaluate(const FrictionOperator& friction, const ContactField& field, const FrictionRange& range,
              const FrictionStage& stage) noexcept {
    const int links = range.last - range.first;
    const auto in_groups = [](int count, const auto& body) {
        constexpr int most = std::min(8, 2 * native_lanes);
        int own = 0;
        for (; own + most <= count; own += most) body.template operator()<most>(own);
        if (most > 4 && count - own >= 4) {
            body.template operator()<4>(own);
            own += 4;
        }
        if (count - own >= 2) {
            body.template operator()<2>(own);
            own += 2;
        }
        if (count - own >= 1) body.template operator()<1>(own);
    };
    in_groups(links + 1, [&]<int W>(int own) { FrictionLanes<P, W, Steepest>(friction, field, range).joints(own); });
    in_groups(links, [&]<int W>(int own) { FrictionLanes<P, W, Steepest>(friction, field, range).links(own, stage); });
}

template <int P>
[[nodiscard]] FrictionKernels kernels_of_order() noexcept {
    return {record<P>, push<P>, evaluate<P, false>, evaluate<P, true>};
}

}  // namespace

template <>
FrictionKernels friction_kernels<compiled_isa>(int order) noexcept {
    switch (order) {
        case 0: return kernels_of_order<0>();
        case 1: return kernels_of_order<1>();
        case 2: return kernels_of_order<2>();
        default: return kernels_of_order<3>();
    }
}

}  // namespace cvtflow::model
