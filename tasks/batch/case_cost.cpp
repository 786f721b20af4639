#include <algorithm>

#include "model/parameters/chain_layout.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::tasks {

namespace {

double cost_of_step(const Scene& scene, const std::optional<Method>& method) {
    return static_cast<double>(std::max(1, method ? method->evaluations_per_step() : 0)) * model::layout_of(scene.parameters).size();
}

}  // namespace

double case_cost(const Sweep& sweep, const Scene& scene) {
    const bool settles = sweep.start == StartMode::settle || (sweep.start == StartMode::scene && scene.state_file.empty());
    const double time = scene.run.until + (settles ? scene.parameters.start.settling_time : 0.0);
    const std::optional<Method> method = Method::find(method_of(scene));
    const double longest = method ? longest_automatic_step(*method, scene.parameters) : usual_longest_step;
    return time / scene.run.step.value_or(longest) * cost_of_step(scene, method);
}

double step_cost(const Scene& scene) { return cost_of_step(scene, Method::find(method_of(scene))); }

}  // namespace cvtflow::tasks
