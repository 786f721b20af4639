#include "model/basis/native_lanes.hpp"
#include "model/contact/sweep_lanes.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/record_pass.hpp"
#include "model/kernels/step_end.hpp"

namespace cvtflow::model {

namespace {

void record(const FrictionOperator& friction, const ChainRange& range, const ContactDrift& drift, const ContactRecord& to, LinkLoad* loads,
            TipSearch* search) noexcept {
    RecordPass<native_lanes>(friction, range, drift, to, loads, search).run();
}

}  // namespace

template <>
FrictionKernels friction_kernels<compiled_isa>() noexcept {
    return {record, sweep_links, sweep_powers, end_links, advance_links, react};
}

}  // namespace cvtflow::model
