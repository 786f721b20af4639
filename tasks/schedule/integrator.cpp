#include "tasks/schedule/integrator.hpp"

#include <algorithm>

#include "tasks/method/method.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::tasks {

namespace {

Partition partition_of(const model::Parameters& parameters, int segments) {
    if (segments > 1 && max_segments(parameters) == 1) throw MethodRefused("detail.pins = \"rigid\" is evaluated in one segment");
    return Partition::equal(parameters.chain.pins, segments);
}

std::unique_ptr<StepMethod> make(const Method& method, Workspace& workspace) {
    try {
        return method.make(workspace);
    } catch (const std::invalid_argument& why) {
        throw MethodRefused(why.what());
    }
}

}  // namespace

Integrator::Integrator(const model::Parameters& parameters, std::string_view method, const std::vector<Schedule>& candidates,
                       const ChooserOptions& options, engine::StampRecorder* recorder)
    : chosen_(resolved_method(method, parameters)),
      workspace_(parameters, chosen_.plan(), partition_of(parameters, candidates.front().segments)),
      method_(make(chosen_, workspace_)),
      runner_(workspace_, *method_, candidates, options, recorder) {}

void Integrator::begin_at(const FrozenStart& start) {
    std::copy(start.state.begin(), start.state.end(), workspace_.state_to_set());
    workspace_.tips.phases = start.phases;
    std::fill(workspace_.tips.changed.begin(), workspace_.tips.changed.end(), -1e300);  // never yet
    method_->restart();
}

void Integrator::adopt(const model::Parameters& parameters) {
    workspace_.adopt(parameters);
    if (chosen_.program() == nullptr) return;
    method_ = make(chosen_, workspace_);  // what a program has derived from the parameters
    runner_.take_method(*method_);
}

}  // namespace cvtflow::tasks
