#pragma once
/// The sweep over the contacts of rigid pins: a whole step at once, on one thread. (model/rigid/rigid_stepper.hpp)

#include <span>
#include <vector>

#include "model/rigid/rigid_stepper.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

class RigidSweep final : public StepMethod, private InnerState {
public:
    explicit RigidSweep(Workspace& workspace);

    [[nodiscard]] NextCycle begin() override;
    [[nodiscard]] NextCycle next() override { return NextCycle::done(); }
    [[nodiscard]] InnerState* inner() noexcept override { return this; }
    void restart() noexcept override { cold_ = true; }
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< memory [what save() wrote]
    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return stepper_.bytes(); }
    [[nodiscard]] Fault fault() const noexcept override { return fault_; }

private:
    void show() override;
    [[nodiscard]] const StepAccount& account() override;
    void start_if_cold();
    [[nodiscard]] bool is_suspect() const noexcept;
    [[nodiscard]] Fault find_fault();

    Workspace& w_;
    model::RigidStepper stepper_;
    double fastest_;  ///< kinetic energy with which no pin can be too fast [J]
    StepAccount account_;
    Fault fault_;
    bool cold_ = true;    ///< the state is in the workspace
    bool shown_ = false;  ///< it is there as well
};

}  // namespace cvtflow::tasks
