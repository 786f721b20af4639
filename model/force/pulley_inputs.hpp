#pragma once
/// Inputs of the pulleys at one instant: torques, and clamping forces by tables, pressures and controllers. (model/EQUATIONS.md section 8)

#include <array>

#include "model/force/hydraulics.hpp"
#include "model/force/shaft_torques.hpp"

namespace cvtflow::model {

/// Input torques, clamping forces and rates of the controllers at one instant.
struct Inputs {
    double drive_torque = 0.0;         ///< on shaft 1 [N·m]
    double load_torque = 0.0;          ///< on shaft 2, negative brakes [N·m]
    std::array<double, 2> clamping{};  ///< S_1, S_2 [N]
    /// I' of the controllers [1], then rates of the hydraulics; zero without them
    std::array<double, 2 + hydraulic_unknowns> control_rate{};
    bool control_limited = false;  ///< a controller asks for more than its authority
};

class PulleyInputs : public ShaftTorques {
public:
    /// Becomes the inputs of other parameters, none held; allocates only what does not fit into the memory it has.
    void adopt(const Parameters& parameters);

    /// Inputs at time t. t [s], tail [unknowns of the pulleys, and behind them integrals I of controllers [s] and the hydraulics', if there
    /// are any]
    [[nodiscard]] Inputs inputs(double t, const double* tail) const noexcept;
    /// Oil with which cylinders have the clamping forces that act at this instant; call it before couple(). t [s], tail as inputs()
    void fill_cylinders(double t, double* tail) const noexcept;
    /// Hydraulics at one instant, and their energies so far; zero without any or before they act. t [s], tail as inputs()
    [[nodiscard]] HydraulicInstant hydraulics(double t, const double* tail) const noexcept;
    [[nodiscard]] HydraulicEnergy hydraulic_energy(const double* tail) const noexcept;  ///< tail as inputs()

private:
    /// One of the machine's controllers: what it holds, by which clamping force, and its gains.
    struct Governing {
        ControlledQuantity quantity = ControlledQuantity::ratio;
        std::size_t shaft = 0;
        double proportional = 0.0, integral = 0.0, authority = 0.0;  ///< [N, N/s, N]
    };
    void add_controllers();
    /// Error of what a controller holds [1]; `built_up` is the force of its shaft without its proportional part [N].
    [[nodiscard]] double control_error(const Governing& by, double now, double load, double built_up, const double* block) const noexcept;
    /// [N]. table: S_2(t) [N], load: M [N·m], block [unknowns of the pulleys]
    [[nodiscard]] double driven_clamping(double table, double load, const double* block) const noexcept;
    /// Clamping forces before limits and controllers: of the tables or a host; by pressures where these are requested. now ≥ 0 [s]
    [[nodiscard]] std::array<double, 2> given_clamping(double now, const double* tail) const noexcept;  ///< tail as inputs()
    [[nodiscard]] Inputs requested(double t, const double* tail) const noexcept;                        ///< as inputs(), before hydraulics
    [[nodiscard]] bool hydraulics_act() const noexcept { return hydraulics_.present() && held().coupled && size() != 0; }
    [[nodiscard]] HydraulicInstant hydraulics_of(double t, const double* tail, const Inputs& requested) const noexcept;
    [[nodiscard]] const double* oil(const double* tail) const noexcept { return tail + 2 * size() + controllers_; }
    [[nodiscard]] CylinderMotion cylinder_motion(const double* block, int shaft) const noexcept;  ///< block [unknowns of the pulleys]

    Clamping clamping_;
    Control control_;
    int controllers_ = 0;
    std::array<Governing, 2> governing_;
    HydraulicModel hydraulics_;
    Start start_;
    double gripping_ = 0.0;         ///< 2μ/cos β, tangential force that a pulley can carry per clamping force [1]
    double reference_speed_ = 0.0;  ///< [rad/s]
};

}  // namespace cvtflow::model
