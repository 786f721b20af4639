#include <algorithm>

#include "engine/record/run/state_file.hpp"
#include "model/parameters/chain_layout.hpp"
#include "tasks/batch/case_engine.hpp"
#include "tasks/method/auto_step.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/saved_start.hpp"

namespace cvtflow::tasks {

namespace {

double cost_of_time(const Scene& scene, double time) {
    const std::optional<Method> method = Method::find(method_of(scene));
    const double longest = method ? longest_automatic_step(*method, scene.parameters) : usual_longest_step;
    return time / scene.run.step.value_or(longest) * step_cost(scene);
}

}  // namespace

double step_cost(const Scene& scene) {
    const std::optional<Method> method = Method::find(method_of(scene));
    return static_cast<double>(std::max(1, method ? method->evaluations_per_step() : 0)) * model::layout_of(scene.parameters).size();
}

double CaseCosts::of_run(const Scene& scene) const { return cost_of_time(scene, scene.run.until); }

double CaseCosts::of_settling(const Scene& scene) const { return cost_of_time(scene, scene.parameters.start.settling_time); }

bool CaseCosts::settles(const Scene& scene) {
    if (sweep_.start != StartMode::scene) return sweep_.start == StartMode::settle;
    if (scene.state_file.empty()) return true;
    if (scene.state_file != known_ || !state_) {
        state_ = saved_start(scene);
        settled_ = settled_layout(*state_, scene);
        known_ = scene.state_file;
    }
    return !has_coordinates(*state_, settled_, scene);
}

}  // namespace cvtflow::tasks
