#include "model/basis/native_lanes.hpp"
#include "model/contact/stage_lanes.hpp"
#include "model/contact/sweep_lanes.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/lane_pass.hpp"
#include "model/kernels/step_end.hpp"

namespace cvtflow::model {

namespace {

void record(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const ContactRecord& to, LinkLoad* loads,
            TipSearch* search) noexcept {
    const ChainModel& chain = friction.chain();
    using Contacts = ContactWriter<native_lanes>;
    LanePass<native_lanes, Contacts>(chain, friction.frictionless(), range, nullptr, loads, {friction, range, drift, to, search}).run();
}

}  // namespace

template <>
FrictionKernels friction_kernels<compiled_isa>() noexcept {
    return {record, evaluate_links, sweep_links, sweep_powers, end_links, advance_links, react};
}

}  // namespace cvtflow::model
