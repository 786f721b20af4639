#pragma once
/// The step of rigid pins: a leapfrog whose friction is implicit and solved where it acts. (model/EQUATIONS.md section 11)

#include <span>
#include <vector>

#include "model/rigid/rigid_chain.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::model {

/// Energy and what became of it, since the start.
struct RigidBalance {
    std::array<double, energy_kinds> energy{};  ///< stored now [J]
    std::array<double, loss_kinds> lost{};      ///< [J]
    std::array<double, work_kinds> worked{};    ///< [J]
    std::array<double, 2> impulse{};            ///< of the torques from outside on both shafts [N·m·s]
    /// Of couplings at both shafts: work of their far ends, and what they have dissipated [J].
    std::array<double, 2> far{}, twisted{};

    [[nodiscard]] double stored() const noexcept;
    [[nodiscard]] double losses() const noexcept;
    [[nodiscard]] double works() const noexcept;
};
/// Change of stored energy minus works plus losses between two instants [J]: zero but for errors of the integration.
[[nodiscard]] double residual(const RigidBalance& from, const RigidBalance& to) noexcept;

/// Between two steps velocities lead the coordinates by half a step; forces are those at the coordinates.
class RigidStepper {
public:
    /// @param variator of rigid pins; must outlive it
    explicit RigidStepper(const Variator& variator);

    /// Begins at a state. @param t [s]   @param y [unknowns]
    void start(double t, const double* y);
    /// From `begin` over a step [s]; the next one is expected to be as long. Allocates nothing.
    void step(double begin, double step) noexcept;

    [[nodiscard]] double time() const noexcept { return time_; }  ///< of coordinates, forces and balance [s]
    [[nodiscard]] const RigidColumns& columns() const noexcept { return columns_; }
    [[nodiscard]] const RigidForces& forces() const noexcept { return forces_; }
    [[nodiscard]] const double* tail() const noexcept { return tail_.data(); }
    [[nodiscard]] const RigidBalance& balance() const noexcept { return balance_; }
    /// Whether a tip presses on its sheave. @param tip 2 end + side
    [[nodiscard]] bool touches(int link, int tip) const noexcept {
        const int pin = tip < rigid_tips / 2 ? link : model_.layout().next(link);
        return columns_[Column::tip_normal + (tip + rigid_tips / 2) % rigid_tips][pin] > 0.0;
    }
    /// Kinetic energy: of pins ½ v·M v' of the velocities around the last kick, of pulleys the mean of both [J].
    [[nodiscard]] double kinetic() const noexcept { return kinetic_; }
    /// State at time(): velocities are means of those before and after. @param y [unknowns]
    void state(double* y) const noexcept;
    /// The unknowns behind the pins alone. @param tail [unknowns - layout.pulley_begin()]
    void tail_state(double* tail) const noexcept;

    /// Memory that a step touches [B].
    [[nodiscard]] std::size_t bytes() const noexcept {
        return sizeof(*this) + columns_.bytes() + (tail_.size() + tail_slope_.size()) * sizeof(double);
    }

    /// Everything that the next step depends on; load() resumes bit for bit.
    void save(std::vector<double>& memory) const;
    /// @throws std::invalid_argument if the memory is not one of this machine
    void load(std::span<const double> memory);

private:
    /// The unknowns that a kick changes behind the pulleys' coordinates: velocities and integrals. Those of the hydraulics drift.
    [[nodiscard]] std::size_t kicked_end() const noexcept;
    void lead(double time) noexcept;      ///< velocities ahead of coordinates by a time [s]
    void evaluate(double kick) noexcept;  ///< forces; kick 0: friction of the velocities as they are
    void kick(double length) noexcept;
    [[nodiscard]] double tail_kinetic() const noexcept;
    [[nodiscard]] double jerked() const noexcept;                         ///< ½ a·M a of the pins [J/s²]
    [[nodiscard]] std::array<double, 2> coupling_rates() const noexcept;  ///< [rad/s], zero where no coupling acts
    void couple(const std::array<double, 2>& rates) noexcept;             ///< powers of the couplings, given rates before the kick
    /// Calls visitor(number) for every number that the next step depends on. @tparam Stepper this class, const or not
    template <class Stepper, class Visitor>
    static void visit(Stepper& stepper, const Visitor& visitor);

    const Variator& variator_;
    const RigidModel& model_;
    double time_ = 0.0, lead_ = 0.0;  ///< [s]
    RigidColumns columns_;
    RigidForces forces_;
    Inputs inputs_;
    std::vector<double> tail_, tail_slope_;                 ///< pulleys, controls, hydraulics
    double kinetic_ = 0.0, tail_kinetic_ = 0.0;             ///< [J]; of the pulleys' velocities as they are
    double shift_ = 0.0;                                    ///< of the kinetic energy by all changes of lead_ so far [J]
    std::array<double, 2> far_power_{}, twist_power_{};     ///< of couplings, in the last kick [W]
    std::array<double, loss_kinds + work_kinds> ledger_{};  ///< of the state at the start [J]
    RigidBalance balance_, total_;                          ///< total_: to the middle of the step behind
};

}  // namespace cvtflow::model
