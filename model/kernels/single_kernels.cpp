/// Friction in single precision, compiled once per instruction set.

#include "model/basis/order.hpp"
#include "model/contact/friction_lanes.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/lanes/lane_pass.hpp"

namespace cvtflow::model {

namespace {

template <int P>
void record_single(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const KickStart& start,
                   LinkLoad* loads) noexcept {
    const ChainModel& chain = friction.chain();
    using Contacts = KickWriter<P, native_lanes>;
    const Contacts contacts(chain.coefficients(), range, drift, friction.by_phase(), start);
    LanePass<P, native_lanes, Contacts>(chain, friction.frictionless(), range, loads, contacts).run();
    contacts.repeat(chain.layout().links);
}

template <int P, bool Steepest>
void evaluate_single(const FrictionOperator& friction, const ContactFieldOf<float>& field, const FrictionRangeOf<float>& range,
                     const FrictionStageOf<float>& stage) noexcept {
    const int links = range.last - range.first;
    over_groups<float>(0, links + 1, [&]<int W>(int own) { FrictionLanes<P, W, Steepest>(friction, field, range).joints(own); });
    over_groups<float>(0, links, [&]<int W>(int own) { FrictionLanes<P, W, Steepest>(friction, field, range).links(own, stage); });
}

}  // namespace

template <>
SingleFrictionKernels single_kernels<compiled_isa>(int order) noexcept {
    return of_order(order, []<int P>() -> SingleFrictionKernels {
        return {record_single<P>, evaluate_single<P, false>, evaluate_single<P, true>};
    });
}

}  // namespace cvtflow::model
