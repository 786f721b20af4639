#include "model/basis/isa.hpp"
#include "model/contact/friction_lanes.hpp"
#include "model/contact/sweep_lanes.hpp"
#include "model/kernels/lane_pass.hpp"
#include "model/kernels/native_kernels.hpp"
#include "model/kernels/step_end.hpp"

namespace cvtflow::model {

namespace {

template <int P>
void record(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const ContactRecord& to, LinkLoad* loads,
            TipSearch* search) noexcept {
    const ChainModel& chain = friction.chain();
    using Contacts = ContactWriter<P, native_lanes>;
    const Contacts contacts(chain.coefficients(), range, drift, friction.by_phase(), to, search);
    LanePass<P, native_lanes, Contacts>(chain, friction.frictionless(), range, loads, contacts).run();
    contacts.repeat(chain.layout().links);
}

}  // namespace

template <>
FrictionKernels friction_kernels<compiled_isa>() noexcept {
    constexpr int P = axis_order;
    return {record<P>, evaluate_links<P, false>, evaluate_links<P, true>, sweep_links<P>, sweep_powers<P>, end_links<P>, advance_links<P>,
            react};
}

}  // namespace cvtflow::model
