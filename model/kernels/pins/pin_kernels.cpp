#include <algorithm>
#include <array>
#include <cstring>

#include "model/basis/order.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/pins/pin_pass.hpp"
#include "model/kernels/pins/pin_tips.hpp"

namespace cvtflow::model {

namespace {

template <int P>
void slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, Account*) noexcept {
    const PinResults results{slope, loads, nullptr, nullptr};
    PinPass<P, native_lanes, false>(model, model.coefficients(), range, results, {}).run();
}

template <int P>
void observed_slopes(const ChainModel& model, const ChainRange& range, double* slope, LinkLoad* loads, Account* accounts,
                     LinkContact* contacts) noexcept {
    const PinResults results{slope, loads, accounts, contacts};
    PinPass<P, native_lanes, true>(model, model.coefficients(), range, results, {}).run();
}

/// A gap as wide as that of a tip that is not there.
constexpr double no_tip = -1.0;  // m

/// Tips of pins side by side against their sheaves, without forces: for detection after every step.
template <int P, int W>
class PinProbe {
public:
    using V = Lanes<W>;
    using Columns = LinkColumns<P, W>;

    PinProbe(const Coefficients& c, const SheaveMotion* sheaves, bool with_slip) noexcept
        : c_(c), sheaves_(sheaves), with_slip_(with_slip), motion_(c.joint) {}

    /// @param states blocks of neighbouring pins, with one more on each side [unknowns]
    void run(const double* states, int pins, TipProbe* probes) noexcept {
        for (int first = 0; first < pins; first += max_pins) {
            const int count = std::min(max_pins, pins - first);
            motion_.read(states + (first - 1) * pin_at<P>.link_block(), count + 2);
            motion_.lines(0, count + 1);
            motion_.roll(1, count + 1);
            for (int pin = 0; pin < count; pin += W) group(pin + 1, std::min(W, count - pin), probes + first + pin);
        }
    }

private:
    void group(int at, int count, TipProbe* probes) const noexcept {
        Columns columns;
        motion_.pin_as_link(at, columns);
        std::array<SheaveMotionLanes<W>, 2> sheaves;
        const V shaft = pulleys_of<P>(c_, sheaves_, columns, sheaves);
        alignas(64) double depth[2][W], slip[2][W], radius[W];
        probe(OneTip<W, End::rear, 0>{}, columns, sheaves.data(), depth[0], slip[0]);
        probe(OneTip<W, End::rear, 1>{}, columns, sheaves.data(), depth[1], slip[1]);
        const V x = columns.q()[model::at<P>.x(End::rear, 0)] - shaft * c_.centre_distance, y = columns.q()[model::at<P>.y(End::rear, 0)];
        V(sqrt(x * x + y * y)).copy_to(radius);
        for (int pin = 0; pin < count; ++pin)
            probes[pin] = {{depth[0][pin], depth[1][pin], no_tip, no_tip}, {slip[0][pin], slip[1][pin], 0.0, 0.0}, radius[pin]};
    }

    template <class Corner>
    void probe(const Corner& corner, const Columns& columns, const SheaveMotionLanes<W>* sheaves, double* depth,
               double* slip) const noexcept {
        const auto own = sheaves_at(corner, sheaves);
        const auto geometry = tip_geometry<P>(c_, corner, columns.frame, columns.q(), own);
        geometry.depth.copy_to(depth);
        V speed(0.0);
        if (with_slip_) {
            const auto along = tangential(tip_motion<P>(c_, corner, columns.frame, columns.v(), own, geometry).material, geometry.normal);
            speed = sqrt(dot(along, along));
        }
        speed.copy_to(slip);
    }

    const Coefficients& c_;
    const SheaveMotion* sheaves_;
    bool with_slip_;
    PinMotion<P, W> motion_;
};

template <int P>
void probe_pin(const ChainModel& model, const double* state, const SheaveMotion* sheaves, bool with_slip, TipProbe& probe) noexcept {
    PinProbe<P, 1>(model.coefficients(), sheaves, with_slip).run(state, 1, &probe);
}

template <int P>
void probe_pins(const ChainModel& model, const double* states, int links, const SheaveMotion* sheaves, bool with_slip,
                TipProbe* probes) noexcept {
    PinProbe<P, native_lanes>(model.coefficients(), sheaves, with_slip).run(states, links, probes);
}

template <int P>
void record(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, ContactField& field,
            Columns& frictionless, LinkLoad* loads) noexcept {
    const ChainModel& chain = friction.chain();
    using Contacts = ContactWriter<P, native_lanes>;
    const Contacts contacts(chain.coefficients(), range, drift, friction.by_phase(), field, frictionless);
    const PinResults results{nullptr, loads, nullptr, nullptr};
    PinPass<P, native_lanes, false, Contacts>(chain, friction.frictionless(), range, results, contacts).run();
    contacts.repeat(chain.layout().links, chain.layout().halo());
}

template <int P>
void record_single(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const SinglePrecisionRecord& start,
                   LinkLoad* loads) noexcept {
    const ChainModel& chain = friction.chain();
    using Contacts = KickWriter<P, native_lanes>;
    const Contacts contacts(chain.coefficients(), range, drift, friction.by_phase(), start);
    const PinResults results{nullptr, loads, nullptr, nullptr};
    PinPass<P, native_lanes, false, Contacts>(chain, friction.frictionless(), range, results, contacts).run();
    contacts.repeat(chain.layout().links, chain.layout().halo());
}

template <class Number, int P, bool Steepest>
void evaluate(const FrictionOperator& friction, const ContactFieldOf<Number>& field, const FrictionRangeOf<Number>& range,
              const FrictionStageOf<Number>& stage) noexcept {
    const int pins = range.last - range.first;
    over_groups<Number>(-1, pins + 1, [&]<int W>(int own) { PinFriction<P, W, Steepest>(friction, field, range).forces(own); });
    over_groups<Number>(0, pins, [&]<int W>(int own) { PinFriction<P, W, Steepest>(friction, field, range).pins(own, stage); });
}

}  // namespace

template <>
PinKernels pin_kernels<compiled_isa>(int order) noexcept {
    return of_order(order, []<int P>() -> PinKernels {
        return {{slopes<P>, observed_slopes<P>, probe_pin<P>, probe_pins<P>},
                {record<P>, evaluate<double, P, false>, evaluate<double, P, true>, {}},
                {record_single<P>, evaluate<float, P, false>, evaluate<float, P, true>, {}}};
    });
}

}  // namespace cvtflow::model
