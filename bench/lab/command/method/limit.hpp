#pragma once
/// The largest stable step of a table of stages on a scene.

#include "bench/lab/show.hpp"
#include "bench/study/spectrum.hpp"
#include "bench/study/stability/stable_step.hpp"

namespace cvtflow::bench {

/// Predicted from the eigenvalues and confirmed by steps about the state.
[[nodiscard]] inline Json limit_json(const engine::StagePlan& plan, const Eigenvalues& values, const model::Variator& variator,
                                     const tasks::FrozenStart& start) {
    const StableStep predicted = largest_stable_step(plan, values);
    const MeasuredStep measured = measured_stable_step(variator, plan, start, predicted.step, extent_of(values).growth);
    return named("method,predicted,limiting,measured,measured_stable,measured_unstable",
                 {plan.name, predicted.step, Json::array({predicted.limiting.real(), predicted.limiting.imag()}), measured.limit(),
                  measured.stable, measured.unstable});
}

}  // namespace cvtflow::bench
