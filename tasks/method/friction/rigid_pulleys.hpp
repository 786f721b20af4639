#pragma once
/// The pulleys in the leapfrog of rigid pins: they drift and are kicked with the pins; and the powers of their inputs and couplings, for
/// the energies that the method counts. Their numbers are those behind the pins in RigidState.

#include <array>

#include "model/rigid/rigid_state.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::tasks {

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
    /// Velocities by a further time, by the rates of the last kick [s].
    void advance(double time) noexcept;

    /// Of the velocities around the last kick: mean of before and after [J].
    [[nodiscard]] double kinetic() const noexcept { return mean_kinetic_; }
    /// Of drive and load in the last kick [N·m].
    [[nodiscard]] std::array<double, 2> torque() const noexcept { return {inputs_.drive_torque, inputs_.load_torque}; }
    [[nodiscard]] model::WorkRates works() const noexcept;  ///< of velocities as they are [W]
    /// Of the couplings' far ends, and what their dampers take, in the last kick [W].
    [[nodiscard]] const std::array<double, 2>& far_power() const noexcept { return far_power_; }
    [[nodiscard]] const std::array<double, 2>& twist_power() const noexcept { return twist_power_; }

    /// Calls visitor(numbers, count) for all that the next step depends on.
    template <class Pulleys, class Visitor>
    static void visit(Pulleys& pulleys, const Visitor& visitor) {
        visitor(&pulleys.kinetic_, 1);
        for (auto* power : {&pulleys.far_power_, &pulleys.twist_power_}) visitor(power->data(), power->size());
        visitor(pulleys.s_.tail.data(), pulleys.s_.tail.size());
        visitor(pulleys.s_.tail_slope.data(), pulleys.s_.tail_slope.size());
        visitor(&pulleys.inputs_.drive_torque, 1);
        visitor(&pulleys.inputs_.load_torque, 1);
        visitor(pulleys.inputs_.clamping.data(), pulleys.inputs_.clamping.size());
    }

private:
    void evaluate(double time) noexcept;                                    ///< rates at a time [s]
    void kick_by_rates(double time) noexcept;                               ///< [s]
    void couple(double time, const std::array<double, 2>& rates) noexcept;  ///< powers of the couplings; rates before the kick [rad/s]
    [[nodiscard]] std::array<double, 2> coupling_rates(double time) const noexcept;  ///< [rad/s], zero where no coupling acts
    [[nodiscard]] double kinetic_now() const noexcept;                               ///< [J]

    const model::Variator& variator_;
    model::RigidState& s_;
    const bool absent_;
    model::SheaveMotion sheaves_[4]{};
    model::Inputs inputs_;
    double kinetic_ = 0.0, mean_kinetic_ = 0.0;          ///< of velocities as they are; kinetic() [J]
    std::array<double, 2> far_power_{}, twist_power_{};  ///< [W]
};

}  // namespace cvtflow::tasks
