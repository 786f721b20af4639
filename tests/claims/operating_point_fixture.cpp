#include "tests/claims/operating_point_fixture.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::claims {

namespace {

const engine::Cancellation no_cancellation;

/// Mean y of the rear halves in the middle of the upper strand: how it moves up and down.
double height_of_strand(const tasks::Workspace& w) {
    const model::ChainLayout& at = w.layout();
    const double middle = 0.5 * w.parameters.pulley.centre_distance;
    double sum = 0.0;
    int count = 0;
    for (int link = 0; link < at.links; ++link) {
        const double* q = w.state() + at.link_begin(link);
        const double x = q[at.x(model::End::rear, 0)];
        const double y = q[at.y(model::End::rear, 0)];
        if (y < 0.0 || std::abs(x - middle) > 0.3 * middle) continue;
        sum += y;
        ++count;
    }
    return count > 0 ? sum / count : 0.0;
}

}  // namespace

tasks::Scene ready_scene(const std::string& name, const std::vector<std::string>& settings) {
    tasks::Scene scene = tasks::read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/" + name + ".toml");
    tasks::set_values(scene, settings);
    return scene;
}

tasks::Scene scene_at_level(const std::string& name, const std::string& level, std::vector<std::string> settings) {
    tasks::Scene scene = ready_scene(name);
    tasks::apply_detail(scene, level);
    settings.insert(settings.begin(),
                    {"start.state=", "run.method=" + tasks::RunSettings{}.method, "run.step=auto", "run.schedule=serial"});
    tasks::set_values(scene, settings);
    return scene;
}

Operation::Operation(const tasks::Scene& scene) : simulation_(scene), observer_(simulation_.workspace().variator) {
    if (simulation_.needs_settling()) fault = simulation_.advance({.until = 0.0}, *this, no_cancellation);
    if (fault) return;
    recording_ = true;
    fault = simulation_.advance({.until = scene.run.until}, *this, no_cancellation);
    counters = simulation_.counters();
    lost = simulation_.workspace().energy.balance().loss;
    balance_error_ratio = simulation_.balance_error_ratio();
}

void Operation::output(double now, const tasks::Workspace& workspace, const tasks::Counters&) {
    if (!recording_) return;
    const model::Observation& o = observer_.observe(now, workspace.state(), workspace.tips.phases.data());
    time.push_back(now);
    ratio.push_back(o.ratio);
    slip.push_back(o.slip);
    friction_slip.push_back(o.friction_slip);
    creep_power.push_back(o.creep.power);
    drive_power.push_back(o.work[0]);
    tight.push_back(o.tight);
    slack.push_back(o.slack);
    driven_speed.push_back(o.speed[1]);
    driven_torque.push_back(o.chain_torque[1]);
    radius.push_back(o.radius[1]);
    chain_speed.push_back(o.chain_speed);
    clamping_driven.push_back(o.clamping[1]);
    thrust_ratio.push_back(o.clamping[1] > 0.0 ? o.clamping[0] / o.clamping[1] : 0.0);
    strand_height.push_back(height_of_strand(workspace));
    for (std::size_t sheave = 0; sheave < 4; ++sheave) axial_force[sheave].push_back(o.axial_force[sheave]);
    tip_axial.push_back(o.tip_axial);
}

double Operation::mean(const std::vector<double>& samples, double from, double to) const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        if (time[k] < from || time[k] >= to) continue;
        sum += samples[k];
        ++count;
    }
    return sum / std::max(1, count);
}

double Operation::mean(const std::vector<double>& samples) const { return mean(samples, -1e300, 1e300); }

}  // namespace cvtflow::claims
