#pragma once
/// Inputs of the pulleys at one instant: where shafts and sheaves are in their block [q | v]; torques of drive, load, couplings and
/// governors; clamping forces by tables, pressures and controllers. (model/EQUATIONS.md section 8)

#include <array>
#include <optional>

#include "model/force/hydraulics.hpp"
#include "model/machine/coefficients.hpp"
#include "model/parameters/chain_layout.hpp"
#include "model/parameters/input_table.hpp"

namespace cvtflow::model {

/// Movable sheave of a shaft: the one at +z on shaft 0, at -z on shaft 1; sign of its side.
[[nodiscard]] constexpr int movable_body(int shaft) noexcept { return sheave_body(shaft, shaft == 0 ? 1 : 0); }
[[nodiscard]] constexpr double movable_side(int shaft) noexcept { return shaft == 0 ? 1.0 : -1.0; }

class PulleyCoordinates {
public:
    /// Coordinates of a body of elastic pulleys.
    enum Freedom { ux = 0, uy = 1, tilt_x = 2, tilt_y = 3, axial = 4, turn = 5 };

    /// Becomes the coordinates of other parameters.
    void adopt(const Parameters& parameters) noexcept;

    [[nodiscard]] int size() const noexcept { return size_; }
    [[nodiscard]] bool elastic() const noexcept { return size_ == 36; }
    /// Index of a shaft's rotation, and of its movable sheave's axial motion, in the pulleys' q.
    [[nodiscard]] int rotation(int shaft) const noexcept { return elastic() ? body_freedom(shaft, turn) : shaft; }
    [[nodiscard]] int sheave_rotation(int shaft, int side) const noexcept {
        return elastic() ? body_freedom(sheave_body(shaft, side), turn) : shaft;
    }
    [[nodiscard]] int movable(int shaft) const noexcept { return elastic() ? body_freedom(movable_body(shaft), axial) : 2 + shaft; }
    /// Speed of shaft 0 or 1. block [unknowns of the pulleys]
    [[nodiscard]] double shaft_speed(const double* block, int shaft) const noexcept { return block[size_ + rotation(shaft)]; }
    /// w of the movable sheave relative to its shaft, of positions or velocities.
    [[nodiscard]] double opening(const double* coordinates, int shaft) const noexcept {
        const double moved = coordinates[movable(shaft)];
        return elastic() ? moved - coordinates[body_freedom(shaft, axial)] : moved;
    }
    /// Running radius by the position of the movable sheave, as a transmission measures it: straight flanks, stiff sheaves [m].
    [[nodiscard]] double running_radius(const double* block, int shaft) const noexcept {
        return arc_position_ - narrowing_ * movable_side(shaft) * opening(block, shaft);
    }

    /// Loss of running radius per opening of the groove, 1/(2 tan β) [1].
    [[nodiscard]] double narrowing() const noexcept { return narrowing_; }

private:
    int size_ = 0;
    double arc_position_ = 0.0;
    double narrowing_ = 0.0;
};

/// Reference angle of a speed-controlled shaft: φ_ref(t) = angle + ∫ω_ref from `since` to t.
struct ReferenceAngle {
    double since = 0.0;  ///< [s]
    double angle = 0.0;  ///< [rad]
    double zero = 0.0;   ///< φ_ref when a coupling took over: hosts count its far end from there [rad]
    bool operator==(const ReferenceAngle&) const = default;
};

/// A coupling at one instant.
struct CouplingState {
    double twist = 0.0, rate = 0.0;  ///< φ_ref - φ [rad], its rate [rad/s]
    double energy = 0.0;             ///< ½ k twist² [J]
    double damping = 0.0;            ///< c [N·m·s/rad]
};

/// The driving sheave at a place, in place of ratio control: a stiff damped spring makes its clamping force.
struct HeldSheave {
    double opening = 0.0;  ///< o_h of the driving groove [m]
    double force = 0.0;    ///< S_h there [N]
    double offset = 0.0;   ///< opening over o_h where the spring takes over: the place is led to o_h from there [m]
    double since = 0.0;    ///< time at which the spring takes over [s]
    bool operator==(const HeldSheave&) const = default;
};

/// Inputs that the caller has set: a value that replaces the scene's table from then on.
struct HeldInputs {
    InputValues values;                         ///< where a speed is set, the reference angle of its shaft continues from `reference`
    std::optional<HeldSheave> sheave;           ///< driving sheave, with ratio control
    std::array<ReferenceAngle, 2> reference{};  ///< one per shaft
    bool coupled = false;  ///< whether couplings, load mode speed and hydraulics have taken over (ShaftTorques::couple)
    bool operator==(const HeldInputs&) const = default;
    /// Calls field(name, value) for all of it.
    template <class Field>
    void visit(Field& field) {
        for (std::size_t k = 0; k < input_count; ++k) field(input_table[k].name, values.value[k]);
        field("references", reference), field("coupled", coupled);
        bool holds = sheave.has_value();
        field("holds_sheave", holds);
        if (!holds) return sheave.reset();
        if (!sheave) sheave.emplace();
        field("sheave", *sheave);
    }
};

class ShaftTorques {
public:
    /// Becomes the torques of other parameters, inputs released; allocates only what does not fit into the memory it has.
    void adopt(const Parameters& parameters);
    [[nodiscard]] const PulleyCoordinates& coordinates() const noexcept { return coordinates_; }

    /// Puts values in place of tables; between steps only.
    void hold(const HeldInputs& held) noexcept { held_ = held; }
    [[nodiscard]] const HeldInputs& held() const noexcept { return held_; }
    /// Angle and speed of what holds shaft 0 or 1 at time t: of a governor's reference, or of a coupling's far end. t [s]
    [[nodiscard]] double reference_angle(double t, int shaft) const noexcept;
    [[nodiscard]] double reference_speed(double t, int shaft) const noexcept;  ///< t [s]
    /// Couplings, and load mode speed, take over: with the twist that carries the torque that acts at this instant. Before, shaft 1 is held
    /// by the governor of mode speed and shaft 2 by load.torque. t [s], block [unknowns of the pulleys]
    void couple(double t, const double* block) noexcept;
    /// Whether a coupling acts on shaft 0 or 1; its state, zero where none does. t [s], block [unknowns of the pulleys]
    [[nodiscard]] bool coupled(int shaft) const noexcept;
    [[nodiscard]] CouplingState coupling(double t, const double* block, int shaft) const noexcept;
    [[nodiscard]] double drive_torque(double t, const double* block) const noexcept;      ///< t [s], block [unknowns of the pulleys]
    [[nodiscard]] double resisting_torque(double t, const double* block) const noexcept;  ///< torque against shaft 2 [N·m]

private:
    /// Torque of the spring that holds a shaft by its angle and speed [N·m]. t [s], block [unknowns of the pulleys]
    [[nodiscard]] double holding_torque(const Spring& by, double t, const double* block, int shaft) const noexcept;
    [[nodiscard]] const TimeTable& speed_table(int shaft) const noexcept { return shaft == 0 ? drive_.speed : load_.speed; }
    [[nodiscard]] const std::optional<double>& held_speed(int shaft) const noexcept {
        return held_.values[shaft == 0 ? Input::drive_speed : Input::load_speed];
    }

    PulleyCoordinates coordinates_;
    Drive drive_;
    Load load_;
    HeldInputs held_;
    std::array<Spring, 2> governor_, holder_;  ///< springs per shaft: of mode speed; of its mode once couplings have taken over
};

/// Input torques, clamping forces and rates of the controllers at one instant.
struct Inputs {
    double drive_torque = 0.0;         ///< torque on shaft 1 from outside [N·m]
    double load_torque = 0.0;          ///< torque on shaft 2 from outside, negative brakes [N·m]
    std::array<double, 2> clamping{};  ///< S_1, S_2 [N]
    std::array<double, 2> drag{};      ///< D_1, D_2 of bearings, seals and oil on the shafts, positive against a positive speed [N·m]
    /// I' of the controllers [1], then rates of the hydraulics; zero without them
    std::array<double, 2 + hydraulic_unknowns> control_rate{};
    bool control_limited = false;  ///< a controller asks for more than its authority
    bool at_floor = false;         ///< the table of shaft 2, and not clamping.safety beside it, decides its clamping force

    /// Torques on the variator's shafts behind bearings and seals, of drive and load [N·m].
    [[nodiscard]] std::array<double, 2> on_shafts() const noexcept { return {drive_torque - drag[0], load_torque - drag[1]}; }
};

/// Quantity that the first controller holds, and the forces that controllers make; zeros without one.
struct ControlInstant {
    double target = 0.0, value = 0.0;  ///< [1]
    std::array<double, 2> force{};     ///< S_1, S_2 where a controller corrects them [N]
    /// Deviation of the value over the target; 0 without one.
    [[nodiscard]] double miss() const noexcept { return target != 0.0 ? value / target - 1.0 : 0.0; }
};

/// Speed that scales the error of ratio control: the largest of drive.speed, or control.reference_speed [rad/s].
[[nodiscard]] double scaling_speed(const Parameters& parameters) noexcept;
/// Friction of all contacts of a pulley along the circumference over its clamping force, 2 mu/cos(beta) [1].
[[nodiscard]] double grip(const Tip& tip) noexcept;
/// Inertia of a shaft with its two sheaves about its axis. @param added  of what the shaft drives or is driven by [kg·m²]
[[nodiscard]] double shaft_inertia(const Pulley& pulley, double added) noexcept;
/// Clamping force of shaft 2 that carries a load with a safety factor [N]. load [N·m], lever: grip() times the running radius of shaft 2
/// [m]
[[nodiscard]] double carrying_clamping(double safety, double load, double lever) noexcept;
/// Clamping force of shaft 2: the table's, and at least what carries the load with the factor `clamping.safety` [N].
/// table [N], load and lever as carrying_clamping()
[[nodiscard]] double driven_clamping(const Clamping& clamping, double table, double load, double lever) noexcept;

class PulleyInputs {
public:
    /// Becomes the inputs of other parameters, none held; allocates only what does not fit into the memory it has.
    void adopt(const Parameters& parameters);
    [[nodiscard]] const ShaftTorques& torques() const noexcept { return torques_; }
    [[nodiscard]] ShaftTorques& torques() noexcept { return torques_; }
    [[nodiscard]] const PulleyCoordinates& coordinates() const noexcept { return torques_.coordinates(); }

    /// Inputs at time t. t [s], tail [unknowns of the pulleys, and behind them integrals I of controllers [s] and the hydraulics', if there
    /// are any]
    [[nodiscard]] Inputs at(double t, const double* tail) const noexcept;
    /// Target and present value of the ratio, of the slip by the sheaves' positions, or of the safety factor. t [s], tail as at()
    [[nodiscard]] ControlInstant controlled(double t, const double* tail, const Inputs& now) const noexcept;
    /// Oil with which cylinders have the clamping forces that act at this instant; call it before couple(). t [s], tail as at()
    void fill_cylinders(double t, double* tail) const noexcept;
    /// Hydraulics at one instant, and their energies so far; zero without any or before they act. t [s], tail as at()
    [[nodiscard]] HydraulicInstant hydraulics(double t, const double* tail) const noexcept;
    [[nodiscard]] HydraulicEnergy hydraulic_energy(const double* tail) const noexcept;  ///< tail as at()

private:
    /// One of the machine's controllers: what it holds, by which clamping force, and its gains.
    struct Governing {
        ControlledQuantity quantity = ControlledQuantity::ratio;
        std::size_t shaft = 0;
        double proportional = 0.0, integral = 0.0, authority = 0.0;  ///< [N, N/s, N]
    };
    /// Error of what a controller holds [1]; `built_up` is the force of its shaft without its proportional part [N].
    [[nodiscard]] double control_error(const Governing& by, double now, double load, double built_up, const double* block) const noexcept;
    /// Torque that shaft 2 can carry per clamping force [m]. block [unknowns of the pulleys]
    [[nodiscard]] double driven_lever(const double* block) const noexcept { return grip_ * coordinates().running_radius(block, 1); }
    /// Slip by the running radii; 0 where shaft 1 stands [1]. block [unknowns of the pulleys]
    [[nodiscard]] double position_slip(const double* block) const noexcept;
    /// Clamping forces before limits and controllers: of the tables or a host; by pressures where these are requested. now ≥ 0 [s]
    [[nodiscard]] std::array<double, 2> given_clamping(double now, const double* tail) const noexcept;  ///< tail as at()
    /// Drag of seals, bearings and oil [N·m]. factor: ramp(t) [1], clamping [N], block [unknowns of the pulleys]
    [[nodiscard]] std::array<double, 2> drag(double factor, const std::array<double, 2>& clamping, const double* block) const noexcept;
    /// Pull of both strands on each shaft's bearings, by the tension that the clamping forces make [N]. block [unknowns of the pulleys]
    [[nodiscard]] double strand_pull(const std::array<double, 2>& clamping, const double* block) const noexcept;
    [[nodiscard]] Inputs requested(double t, const double* tail) const noexcept;  ///< result of at() before hydraulics
    [[nodiscard]] bool hydraulics_act() const noexcept {
        return hydraulics_.present() && torques_.held().coupled && coordinates().size() != 0;
    }
    [[nodiscard]] HydraulicInstant hydraulics_of(double t, const double* tail, const Inputs& requested) const noexcept;
    [[nodiscard]] const double* oil(const double* tail) const noexcept { return tail + 2 * coordinates().size() + controllers_; }
    [[nodiscard]] CylinderMotion cylinder_motion(const double* block, int shaft) const noexcept;  ///< block [unknowns of the pulleys]

    ShaftTorques torques_;
    Clamping clamping_;
    Control control_;
    int controllers_ = 0;
    std::array<Governing, 2> governing_;
    HydraulicModel hydraulics_;
    Start start_;
    Drag drag_;
    double centre_distance_ = 0.0;  ///< [m]
    double wedge_ = 0.0;            ///< 2 tan β [1]
    double grip_ = 0.0;             ///< [1]
    double reference_speed_ = 0.0;  ///< [rad/s]
};

}  // namespace cvtflow::model
