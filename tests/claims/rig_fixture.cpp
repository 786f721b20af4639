#include "tests/claims/rig_fixture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

void soften(model::Parameters& p) {
    p.detail.friction = model::FrictionLaw::smoothed;
    p.detail.smoothing = 0.5;
    for (model::Friction* friction : {&p.plate.friction, &p.joint.friction, &p.tip.friction}) friction->saturation_speed = 1e3;
    p.joint.clearance = 1e-3;  // the opening's spring begins beyond reach
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

model::Parameters free_ring(int pins, double speed) {
    model::Parameters p;
    p.detail.pulleys = model::PulleyDetail::absent;
    p.start.layout = model::StartLayout::ring;
    p.start.ring_speed = speed;
    p.chain.pins = pins;
    return p;
}

void jolt(const model::ChainLayout& at, double* state) {
    for (int link = 0; link < at.links; ++link) {
        for (int k = 0; k < at.link_size(); ++k) state[at.link_begin(link) + at.link_size() + k] += 0.02 * std::sin(1.0 + link + 3.0 * k);
    }
}

Smooth disturbed_ring() {
    model::Parameters p = free_ring(24, 600.0);
    soften(p);
    Rig rig(p);
    Smooth scene{p, rig.state_copy(), rig.phases()};
    jolt(rig.variator().layout(), scene.state.data());
    return scene;
}

Smooth clamped_ring() {
    model::Parameters p;
    soften(p);
    p.start.layout = model::StartLayout::ring;
    p.start.ring_speed = 200.0;
    p.start.settling_time = p.start.ramp_time = 1e-3;
    p.chain.pins = 13;
    p.pulley.arc_position = 16.8e-3;
    p.pulley.innermost = 10e-3;
    p.drive.speed = model::TimeTable(200.0);
    p.load.torque = model::TimeTable(0.0);
    p.clamping = {model::TimeTable(15e3), model::TimeTable(0.0)};
    Rig rig(p);
    EXPECT_FALSE(rig.run({-1e-3, 0.0, 5e-8, 1e-3}));
    Smooth scene{p, rig.state_copy(), rig.phases()};
    for (const model::Phase phase : scene.phases) EXPECT_EQ(phase, model::Phase::touching);
    jolt(rig.variator().layout(), scene.state.data());
    return scene;
}

double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double square = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) square += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(square);
}

}  // namespace cvtflow::claims
