/// Friction in single precision, compiled once per instruction set.

#include <algorithm>

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
    // Two vectors side by side as long as there are links for more than one; the last group's lanes beyond the range are thrown away.
    const auto in_groups = [](int count, const auto& body) {
        constexpr int most = std::min(float_lanes, 2 * native_floats);
        int own = 0;
        for (; count - own > native_floats; own += most) body.template operator()<singles<most>>(own);
        if (own < count) body.template operator()<singles<native_floats>>(own);
    };
    in_groups(links + 1, [&]<int W>(int own) { FrictionLanes<P, W, Steepest>(friction, field, range).joints(own); });
    in_groups(links, [&]<int W>(int own) { FrictionLanes<P, W, Steepest>(friction, field, range).links(own, stage); });
}

}  // namespace

template <>
SingleFrictionKernels single_kernels<compiled_isa>(int order) noexcept {
    return of_order(order, []<int P>() -> SingleFrictionKernels {
        return {record_single<P>, evaluate_single<P, false>, evaluate_single<P, true>};
    });
}

}  // namespace cvtflow::model
