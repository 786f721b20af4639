#include <algorithm>
#include <cmath>
#include <limits>

#include "model/basis/order.hpp"
#include "model/contact/friction_lanes.hpp"
#include "model/kernels/chain_parts.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/lanes/lane_pass.hpp"

namespace cvtflow::model {

namespace {

template <int P>
void record(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, ContactField& field,
            Columns& frictionless, LinkLoad* loads) noexcept {
    const ChainModel& chain = friction.chain();
    using Contacts = ContactWriter<P, native_lanes>;
    const Contacts contacts(chain.coefficients(), range, drift, friction.by_phase(), field, frictionless);
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

}  // namespace

template <>
FrictionKernels friction_kernels<compiled_isa>(int order) noexcept {
    return of_order(order, []<int P>() -> FrictionKernels { return {record<P>, evaluate<P, false>, evaluate<P, true>}; });
}

}  // namespace cvtflow::model
