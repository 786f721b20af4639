#pragma once
/// The step of rigid whole pins: a leapfrog whose friction is implicit and solved where it acts. (model/EQUATIONS.md section 11)

#include "model/variator/rigid/rigid_model.hpp"

namespace cvtflow::model {

/// Energy and what became of it, at the instant of the last evaluation.
struct RigidBalance {
    double time = 0.0;                          ///< [s]
    std::array<double, energy_kinds> energy{};  ///< stored [J]
    std::array<double, loss_kinds> lost{};      ///< since the start [J]
    std::array<double, work_kinds> worked{};    ///< since the start [J]

    [[nodiscard]] double stored() const noexcept;
    [[nodiscard]] double losses() const noexcept;
    [[nodiscard]] double works() const noexcept;
};
/// Change of stored energy minus works plus losses between two instants [J]: zero but for errors of the integration.
[[nodiscard]] double residual(const RigidBalance& from, const RigidBalance& to) noexcept;

/// Integrates by steps of one length. Velocities lead: those of the columns belong to half a step before the coordinates.
class RigidStepper {
public:
    /// @param model must outlive it   @param step [s]
    RigidStepper(const RigidModel& model, double step);

    /// Begins at a state. @param t [s]   @param y [unknowns]
    void start(double t, const double* y);
    /// One step. Allocates nothing.
    void step() noexcept;

    [[nodiscard]] double time() const noexcept { return start_ + static_cast<double>(steps_) * step_; }  ///< of the coordinates [s]
    [[nodiscard]] double step_length() const noexcept { return step_; }
    [[nodiscard]] const RigidColumns& columns() const noexcept { return columns_; }
    [[nodiscard]] const double* tail() const noexcept { return tail_.data(); }
    [[nodiscard]] const RigidForces& forces() const noexcept { return forces_; }
    [[nodiscard]] const RigidModel& model() const noexcept { return model_; }
    /// At the instant at which the last step evaluated the forces, one step before time().
    [[nodiscard]] const RigidBalance& balance() const noexcept { return balance_; }
    /// State at time(), with velocities advanced by half a step as they change now. @param y [unknowns]
    void state(double* y) const noexcept;

private:
    void advance_tail() noexcept;                       ///< pulleys and controls
    void keep_balance(double kinetic_before) noexcept;  ///< kinetic_before [J]

    const RigidModel& model_;
    double step_;  ///< [s]
    double start_ = 0.0;
    long steps_ = 0;
    RigidColumns columns_;
    RigidForces forces_;
    std::vector<double> tail_, tail_slope_;
    double kinetic_ = 0.0;  ///< of the velocities as they are [J]
    WorkRates work_rate_{};
    RigidBalance balance_, total_;
};

}  // namespace cvtflow::model
