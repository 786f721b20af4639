/// Friction in single precision, compiled once per instruction set.

#include "model/basis/isa.hpp"
#include "model/contact/friction_lanes.hpp"
#include "model/contact/sweep_lanes.hpp"
#include "model/kernels/lane_pass.hpp"
#include "model/kernels/native_kernels.hpp"
#include "model/kernels/step_end.hpp"

namespace cvtflow::model {

namespace {

template <int P>
void record_single(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const SinglePrecisionRecord& start,
                   LinkLoad* loads, TipSearch* search) noexcept {
    const ChainModel& chain = friction.chain();
    using Contacts = KickWriter<P, native_lanes>;
    const Contacts contacts(chain.coefficients(), range, drift, friction.by_phase(), start, search);
    LanePass<P, native_lanes, Contacts>(chain, friction.frictionless(), range, loads, contacts).run();
    contacts.repeat(chain.layout().links);
}

}  // namespace

template <>
SingleFrictionKernels single_kernels<compiled_isa>(int order) noexcept {
    return of_order(order, []<int P>() -> SingleFrictionKernels {
        return {record_single<P>,
                evaluate_links<float, P, false>,
                evaluate_links<float, P, true>,
                {sweep_links<float, P>, sweep_powers<float, P>, end_links<float, P>, advance_links<P>, react<float>}};
    });
}

}  // namespace cvtflow::model
