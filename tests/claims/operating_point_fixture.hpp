#pragma once
/// Runs a ready scene and keeps the figures that claims check.

#include <array>
#include <string>
#include <vector>

#include "model/observe/observation.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::claims {

/// One ready scene, changed by settings "key=value".
[[nodiscard]] tasks::Scene ready_scene(const std::string& name, const std::vector<std::string>& settings = {});

/// One ready scene at a level of detail with the default method and automatic steps, settled again, changed by settings.
[[nodiscard]] tasks::Scene scene_at_level(const std::string& name, const std::string& level, std::vector<std::string> settings = {});

/// Observations at the output times with t ≥ 0.
class Operation final : public tasks::RunObserver {
public:
    /// Settles if the scene needs it, then runs to its run.until.
    explicit Operation(const tasks::Scene& scene);

    void output(double time, const tasks::Workspace& workspace, const tasks::Counters& counters) override;
    void transition(const tasks::TransitionRecord&) override { ++transitions; }

    /// Mean of a sampled quantity over [from, to) seconds.
    [[nodiscard]] double mean(const std::vector<double>& samples, double from, double to) const;
    [[nodiscard]] double mean(const std::vector<double>& samples) const;

    tasks::Fault fault;
    tasks::Counters counters;
    long transitions = 0;
    double lost = 0.0;                 ///< losses behind settling [J]
    double balance_error_ratio = 0.0;  ///< balance error ratio of the energy watch, settling included; above 1 the figures are wrong
    std::vector<double> time, ratio, slip, friction_slip, creep_power, drive_power, tight, slack, driven_speed, driven_torque, radius,
        chain_speed, clamping_driven, thrust_ratio, strand_height;
    std::array<std::vector<double>, 4> axial_force;
    std::vector<std::vector<double>> tip_axial;  ///< [output][tip] [N]

private:
    bool recording_ = false;
    tasks::Simulation simulation_;
    model::Observer observer_;
};

}  // namespace cvtflow::claims
