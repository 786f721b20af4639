#pragma once
/// Leapfrog of rigid pins, with implicit friction solved where it acts. (model/EQUATIONS.md section 11)
///
///     links ─► press ─► plates ─► rub ─► kick     one task each, of the whole chain
///
/// Between steps velocities are half a step ahead of coordinates; forces are those at the coordinates. All of it is in the workspace's
/// columns, which are the state while this method runs. Works and losses are sums of what each step does.

#include <array>
#include <span>
#include <vector>

#include "model/rigid/rigid_chain.hpp"
#include "model/variator/variator.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// The pulleys in the leapfrog of rigid pins: they drift and are kicked with the pins. Their numbers are those after the pins in
/// RigidState.
class RigidPulleys {
public:
    RigidPulleys(const model::Variator& variator, model::RigidState& state) noexcept
        : variator_(variator), s_(state), absent_(variator.layout().pulley_size == 0) {}

    [[nodiscard]] bool absent() const noexcept { return absent_; }
    /// [4]; nullptr without pulleys.
    [[nodiscard]] const model::SheaveMotion* sheaves() const noexcept { return absent_ ? nullptr : sheaves_; }
    /// The motion of the sheaves, by coordinates and velocities as they are.
    void place() noexcept;
    /// Coordinates by velocities over a step [s]; then place().
    void drift(double step) noexcept;
    /// Begins at a time [s], after the forces of the pins.
    void start(double time) noexcept;
    /// Velocities at the end of the step by the reactions of the tips. @param time of the coordinates [s]   @param step [s]
    /// @return powers of the inputs, of the mean of the velocities before and after [W]
    [[nodiscard]] model::WorkRates kick(double time, double step) noexcept;
    /// Velocities by a time, at the rates of the last kick [s].
    void advance(double time) noexcept;

    /// Kinetic energy around the last kick: mean of before and after [J].
    [[nodiscard]] double kinetic() const noexcept { return mean_kinetic_; }
    /// Torques of drive and load, and of the shafts' drag, in the last kick [N·m].
    [[nodiscard]] std::array<double, 2> torque() const noexcept { return {inputs_.drive_torque, inputs_.load_torque}; }
    [[nodiscard]] const std::array<double, 2>& drag() const noexcept { return inputs_.drag; }
    [[nodiscard]] model::WorkRates works() const noexcept;  ///< powers of the inputs at the present velocities [W]
    /// Power of the shafts' drag, mean of before and after the last kick [W].
    [[nodiscard]] const std::array<double, 2>& drag_power() const noexcept { return drag_power_; }
    /// Powers of the couplings' far ends and of their dampers in the last kick [W].
    [[nodiscard]] const std::array<double, 2>& far_power() const noexcept { return far_power_; }
    [[nodiscard]] const std::array<double, 2>& twist_power() const noexcept { return twist_power_; }

    /// All that the next step depends on.
    void visit(engine::Archive& archive) {
        archive("pulleys_kinetic", kinetic_), archive("far_power", far_power_), archive("twist_power", twist_power_);
        archive("drag_power", drag_power_), archive("drag", inputs_.drag);
        archive("pulleys", std::span(s_.tail)), archive("pulleys_slope", std::span(s_.tail_slope));
        archive("drive_torque", inputs_.drive_torque), archive("load_torque", inputs_.load_torque), archive("clamping", inputs_.clamping);
    }

private:
    void evaluate(double time) noexcept;                                    ///< rates at a time [s]
    void couple(double time, const std::array<double, 2>& rates) noexcept;  ///< powers of the couplings; rates before the kick [rad/s]
    [[nodiscard]] std::array<double, 2> coupling_rates(double time) const noexcept;  ///< [rad/s], zero where no coupling acts
    [[nodiscard]] double kinetic_now() const noexcept;                               ///< [J]

    const model::Variator& variator_;
    model::RigidState& s_;
    const bool absent_;
    model::SheaveMotion sheaves_[4]{};
    model::Inputs inputs_;
    double kinetic_ = 0.0, mean_kinetic_ = 0.0;                         ///< kinetic energies: at the present velocities; kinetic() [J]
    std::array<double, 2> far_power_{}, twist_power_{}, drag_power_{};  ///< [W]
};

class RigidLeapfrog final : public StepMethod {
public:
    static constexpr int state_slots = 1, slope_slots = 1;

    /// Requires parameters with rigid pins.
    explicit RigidLeapfrog(Workspace& workspace);

    [[nodiscard]] CycleSequence step() override;
    [[nodiscard]] AtTransition at_transition() const noexcept override { return AtTransition::inside; }
    void add_tasks(engine::TaskGraph& graph) override;
    void restart() noexcept override { cold_ = true; }
    void phases_changed() noexcept override {}
    void start() override;
    void visit(engine::Archive& archive) override;
    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return sizeof(*this); }

    // Bodies of tasks.
    void links(int) noexcept;   ///< coordinates by the whole step; forces of links
    void press(int) noexcept;   ///< normal forces of the tips
    void plates(int) noexcept;  ///< friction of plates along the pins, and of halves on each other
    void rub(int) noexcept;     ///< friction of the tips
    void kick(int) noexcept;    ///< accelerations, and velocities by them

private:
    void set_lead(double lead) noexcept;                        ///< velocities ahead of coordinates by a time [s]
    void finish() noexcept;                                     ///< pulleys, energies and phases of the tips
    void count_energy(const model::WorkRates& power) noexcept;  ///< [W]
    /// Energies `to` as `from` and what a time [s] at the rates of the last kick adds. power of the inputs [W]
    void add_energies(const EnergyAccount& from, double time, const model::WorkRates& power, EnergyAccount& to) const noexcept;
    [[nodiscard]] bool is_suspect() const noexcept;

    Workspace& w_;
    model::RigidState& pins_;
    const model::RigidCoefficients& c_;
    const model::RigidKernels<float>& kernel_;
    RigidPulleys pulleys_;
    EnergyAccount& account_;
    EnergyAccount half_way_;      ///< account_ in the middle of the last step
    const double fastest_;        ///< kinetic energy with which no pin can be too fast [J]
    model::RigidKick kick_;       ///< kick of the present step
    double kinetic_ = 0.0;        ///< kinetic energy around the last kick [J]
    double shift_ = 0.0;          ///< sum of changes of the kinetic energy by changes of the lead [J]
    std::vector<double> ledger_;  ///< ledger of the start state [J]
    bool cold_ = true;            ///< the state is in the workspace's slot
};

}  // namespace cvtflow::tasks
