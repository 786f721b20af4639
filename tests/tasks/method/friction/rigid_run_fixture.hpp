#pragma once
/// The leapfrog of rigid pins step by step, by its tasks on one thread, without a controller that observes or judges.

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include "engine/executor/serial.hpp"
#include "tasks/method/method.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks::test {

class RigidRun {
public:
    explicit RigidRun(const model::Parameters& parameters)
        : workspace_(parameters, method_.plan(), Partition::equal(parameters.chain.pins, 1)),
          step_method_(method_.make(workspace_)),
          graph_(step_graph(workspace_, {}, step_method_.get())) {}

    /// Begins at a state. @param time [s]   @param y [unknowns]
    void start(double time, const double* y) {
        std::copy_n(y, workspace_.layout().size(), workspace_.state_to_set());
        workspace_.step.time = time;
        step_method_->restart();
        step_method_->load({});
    }
    /// One step of a length [s].
    void step(double length) {
        workspace_.step.h = length;
        OneStep controller{step_method_->step()};
        executor_.run(graph_, &workspace_, controller);
        workspace_.step.time += length;
    }
    void steps(double length, long count) {
        for (long k = 0; k < count; ++k) step(length);
    }

    [[nodiscard]] double time() const { return workspace_.step.time; }
    [[nodiscard]] std::vector<double> state() const {
        const double* y = workspace_.state();
        return {y, y + workspace_.layout().size()};
    }
    [[nodiscard]] const std::vector<model::Phase>& phases() const { return workspace_.tips.phases; }
    [[nodiscard]] const EnergyAccount& energies() { return workspace_.energy.count(); }
    [[nodiscard]] const model::Variator& variator() const { return workspace_.variator; }
    [[nodiscard]] StepMethod& method() { return *step_method_; }
    [[nodiscard]] const engine::TaskGraph& graph() const { return graph_; }

private:
    struct OneStep final : engine::Controller {
        explicit OneStep(CycleSequence step) : cycles(std::move(step)) {}
        [[nodiscard]] int next() noexcept override { return cycles.next(); }
        CycleSequence cycles;
    };

    const Method method_{"leapfrog-rigid"};
    Workspace workspace_;
    std::unique_ptr<StepMethod> step_method_;
    engine::TaskGraph graph_;
    engine::Serial executor_;
};

[[nodiscard]] inline double total(const auto& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
[[nodiscard]] inline double lost(const EnergyAccount& from, const EnergyAccount& to) { return total(to.lost) - total(from.lost); }
/// Change of stored energy minus works plus losses [J]: zero but for errors of the integration.
[[nodiscard]] inline double residual(const EnergyAccount& from, const EnergyAccount& to) {
    return (to.stored - from.stored) - (total(to.work) - total(from.work)) + lost(from, to);
}

}  // namespace cvtflow::tasks::test
