#pragma once
/// cvtflow-lab compare --front: which choices are on the Pareto front of error and time, confirmed by longer runs.

#include <functional>
#include <string>
#include <vector>

#include "bench/lab/report/compare_report.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace cvtflow::bench {

struct FrontArguments {
    std::string confirm = "20 ms", reference;
};

/// --confirm, --confirm-against. @param front the option that they need
void declare_front(CLI::App& app, CLI::Option* front, FrontArguments& arguments);
/// interval [s]. @throws tasks::SceneError
[[nodiscard]] ConfirmSettings confirm_settings(const FrontArguments& arguments, double interval);
/// @throws tasks::SimulationError if the energy balance of the reference does not close
void require_reliable(const std::string& scene, const std::string& choice, const Trajectory& reference);

class ParetoFront {
public:
    /// Runs the reference of the confirmation. @throws as Confirmation
    ParetoFront(const tasks::Scene& scene, const ConfirmSettings& settings, const engine::Cancellation& cancel,
                std::function<void(const std::string&)> progress);

    /// Fills in the results of the choices, and the confirmation in the setting.
    void judge(std::vector<ComparedChoice>& choices, CompareSetting& setting);

private:
    void judge_steps(std::vector<ComparedChoice>& choices);

    const engine::Cancellation& cancel_;
    std::function<void(const std::string&)> progress_;
    double duration_;  ///< [s]
    Confirmation confirmation_;
};

}  // namespace cvtflow::bench
