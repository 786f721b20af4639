#include "tasks/stage_method.hpp"

#include <algorithm>

#include "tasks/step_graph.hpp"

namespace cvtflow::tasks {

void close_evaluation(Workspace& w, double time, const double* tail, double* slope) noexcept {
    ++w.evaluations;
    w.variator.close(time, tail, w.phases.data(), w.loads.data(), w.accounts.data(), slope + w.layout().pulley_begin());
}

int StageMethod::start_stage(int stage) {
    stage_ = stage;
    w_.evaluate_end = false;
    w_.row = w_.plan.stage(stage);
    w_.slope_out = w_.slopes[static_cast<std::size_t>(w_.row.slope)];
    const model::ChainLayout& at = w_.layout();
    engine::combine(w_.row, w_.h, w_.slots(), at.pulley_begin(), at.size(), w_.tail.data());
    if (w_.row.keep >= 0) std::copy(w_.tail.begin(), w_.tail.end(), w_.states[static_cast<std::size_t>(w_.row.keep)] + at.pulley_begin());
    if (at.pulley_size != 0) w_.variator.pulleys().motions(w_.tail.data(), w_.sheaves);
    return evaluate_cycle;
}

int StageMethod::next() {
    close_evaluation(w_, w_.time + w_.row.time * w_.h, w_.tail.data(), w_.slope_out);
    if (stage_ + 1 < w_.plan.stages()) return start_stage(stage_ + 1);
    w_.row = w_.plan.result();
    return done;
}

}  // namespace cvtflow::tasks
