#pragma once
/// Leapfrog of rigid pins, with implicit friction solved where it acts. (model/EQUATIONS.md section 11)
///
///     links ─► plates ─► tips ─► kick     one task each, of the whole chain
///
/// Between steps velocities are half a step ahead of coordinates; forces are those at the coordinates. All of it is in the workspace's
/// columns, which are the state while this method runs. Works and losses are sums of what each step does.

#include <array>
#include <span>
#include <vector>

#include "model/rigid/rigid_state.hpp"
#include "tasks/method/friction/rigid_pulleys.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

class RigidLeapfrog final : public StepMethod {
public:
    static constexpr int state_slots = 1, slope_slots = 1;

    /// For parameters with rigid pins.
    explicit RigidLeapfrog(Workspace& workspace);

    [[nodiscard]] CycleSequence step() override;
    [[nodiscard]] AtTransition at_transition() const noexcept override { return AtTransition::inside; }
    void add_tasks(engine::TaskGraph& graph) override;
    void restart() noexcept override { cold_ = true; }
    void phases_changed() noexcept override {}
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< @param memory from save(); empty: starts from the workspace's state
    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return sizeof(*this); }

    // Bodies of tasks.
    void links(int) noexcept;   ///< coordinates half a step on each side of the forces; forces of links
    void plates(int) noexcept;  ///< friction of plates along the pins, and of halves on each other
    void tips(int) noexcept;    ///< normal forces and friction of the tips
    void kick(int) noexcept;    ///< accelerations, and velocities by them

private:
    void start();
    void set_lead(double lead) noexcept;  ///< velocities ahead of coordinates by a time [s]
    void kick_pins() noexcept;            ///< velocities by accelerations, over the step
    void finish() noexcept;               ///< pulleys, energies and phases of the tips
    void find_touching() noexcept;        ///< phases of tips: touching where they press
    void forget_touching() noexcept;
    void set_phase(int pin, int tip, bool touches) noexcept;
    void count_energy(const model::WorkRates& power) noexcept;  ///< [W]
    [[nodiscard]] bool is_suspect() const noexcept;
    [[nodiscard]] Fault find_fault() const;
    /// Calls visitor(numbers, count) for all that the next step depends on. @tparam Method this class, const or not
    template <class Method, class Visitor>
    static void visit(Method& method, const Visitor& visitor);

    Workspace& w_;
    model::RigidState& pins_;
    RigidPulleys pulleys_;
    EnergyAccount& account_;
    EnergyAccount half_way_;      ///< account_ in the middle of the last step
    const double fastest_;        ///< kinetic energy with which no pin can be too fast [J]
    model::RigidKick kick_;       ///< of the step
    double kinetic_ = 0.0;        ///< of the velocities around the last kick [J]
    double shift_ = 0.0;          ///< of the kinetic energy by all changes of the lead so far [J]
    std::vector<double> ledger_;  ///< of the state at the start [J]
    bool cold_ = true;            ///< the state is in the workspace's slot
};

}  // namespace cvtflow::tasks
