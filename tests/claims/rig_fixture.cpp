#include "tests/claims/rig_fixture.hpp"

#include <algorithm>

#include "tasks/scene/scene.hpp"

namespace cvtflow::claims {

namespace {

class Listener final : public tasks::RunObserver {
public:
    Listener(const Rig::Output& output, std::vector<tasks::TransitionRecord>& transitions) : output_(output), transitions_(transitions) {}
    void output(double time, const tasks::Workspace& workspace, const tasks::Counters&) override {
        if (output_) output_(time, workspace);
    }
    void transition(const tasks::TransitionRecord& record) override { transitions_.push_back(record); }

private:
    const Rig::Output& output_;
    std::vector<tasks::TransitionRecord>& transitions_;
};

std::vector<tasks::Schedule> one_schedule(int segments) {
    tasks::Schedule schedule;
    schedule.segments = segments;
    return {schedule};
}

}  // namespace

Rig::Rig(const model::Parameters& parameters, const std::vector<double>& state, const std::vector<model::Phase>& phases, int segments,
         std::string_view method)
    : integrator_(std::make_unique<tasks::Integrator>(parameters, std::string(method), one_schedule(segments))) {
    integrator_->begin_at({0.0, state, phases});
}

Rig::Rig(const model::Parameters& parameters, int segments, std::string_view method)
    : Rig(parameters, model::start_state(parameters).state, std::vector<model::Phase>(static_cast<std::size_t>(4 * parameters.chain.pins)),
          segments, method) {}

tasks::Fault Rig::run(const tasks::StepSettings& settings, const Output& output) {
    const engine::Cancellation never;
    transitions_.clear();
    Listener listener(output, transitions_);
    tasks::StepController controller(workspace(), integrator_->method(), settings, listener, never);
    integrator_->run(controller);
    counters_ = controller.counters();
    controller.rethrow();
    return controller.fault();
}

std::vector<double> Rig::state_copy() const { return {state(), state() + variator().layout().size()}; }

std::vector<std::string> levels() {
    std::vector<std::string> names;
    for (const tasks::DetailPreset& preset : tasks::detail_presets()) {
        if (preset.pins != model::PinDetail::rigid) names.emplace_back(preset.name);
    }
    return names;
}

model::Parameters at_level(model::Parameters parameters, const std::string& level) {
    tasks::Scene scene;
    scene.parameters = std::move(parameters);
    tasks::apply_detail(scene, level);
    return scene.parameters;
}

void make_conservative(model::Parameters& p) {
    p.chain.damping_ratio = 0.0;
    p.pulley.damping_ratio = 0.0;
    p.pulley.cylinder_damping = 0.0;
    for (model::Friction* friction : {&p.plate.friction, &p.joint.friction, &p.tip.friction}) friction->coefficient = 0.0;
}

}  // namespace cvtflow::claims
