#pragma once
/// Shafts, sheaves, their supports, clamping, drive, load and control. (model/EQUATIONS.md section 8)

#include <array>
#include <optional>
#include <vector>

#include "model/force/account.hpp"
#include "model/force/hydraulics.hpp"
#include "model/force/sheave_motion.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {

/// Generalized forces of the chain on the four sheaves, number 2 shaft + side: (F_x, F_y, M_τx, M_τy, F_z, M_φ).
using SheaveForces = std::array<std::array<double, 6>, 4>;

/// Inputs from outside at one instant.
struct Inputs {
    double drive_torque = 0.0;         ///< on shaft 1 [N·m]
    double load_torque = 0.0;          ///< on shaft 2, negative brakes [N·m]
    std::array<double, 2> clamping{};  ///< S_1, S_2 [N]
    /// I' of the controllers [1], then rates of the hydraulics; zero without them
    std::array<double, 2 + hydraulic_unknowns> control_rate{};
    bool control_limited = false;  ///< a controller asks for more than its authority
};

/// Angle of what holds a shaft by its speed: φ_ref(t) = angle + ∫ω_ref from `since` to t.
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

/// Inputs that the caller has set: a value that replaces the scene's table from then on.
struct HeldInputs {
    std::optional<double> driving;              ///< S_1 [N]
    std::optional<double> driven;               ///< S_2 [N]
    std::optional<double> load_torque;          ///< against the travel of shaft 2 [N·m]
    std::optional<double> drive_torque;         ///< drive mode torque [N·m]
    std::optional<double> drive_speed;          ///< drive modes speed and coupling [rad/s]; the reference angle continues from reference[0]
    std::optional<double> load_speed;           ///< load modes speed and coupling [rad/s]; the reference angle continues from reference[1]
    std::optional<double> ratio;                ///< of ratio control [1]
    std::optional<double> driving_pressure;     ///< hydraulics.mode pressure [Pa]
    std::optional<double> driven_pressure;      ///< [Pa]
    std::array<ReferenceAngle, 2> reference{};  ///< of the shafts
    bool coupled = false;                       ///< whether couplings, load mode speed and hydraulics have taken over (PulleyModel::couple)
    bool operator==(const HeldInputs&) const = default;
};

/// Load on the bearings of a shaft: force and moment of the shaft on the housing.
struct BearingLoad {
    std::array<double, 3> force{};   ///< x, y, axial [N]
    std::array<double, 2> moment{};  ///< about x, y, at the middle of the shaft [N·m]
};

/// Powers of the inputs [W].
using WorkRates = std::array<double, work_kinds>;

class PulleyModel {
public:
    explicit PulleyModel(const Parameters& parameters);
    /// Becomes the model of other parameters, inputs released; allocates only what does not fit into the memory it has.
    void adopt(const Parameters& parameters);

    [[nodiscard]] int size() const noexcept { return size_; }
    /// Whether a flank moves as its shaft turns.
    [[nodiscard]] bool eccentric() const noexcept { return imperfection_.runout != 0.0; }
    /// Positions and velocities of the four sheaves from the pulleys' block [q | v].
    void motions(const double* block, SheaveMotion* sheaves) const noexcept;
    /// Running radius by the position of the movable sheave, as a transmission measures it: straight flanks, stiff sheaves [m].
    [[nodiscard]] double running_radius(const double* block, int shaft) const noexcept;
    /// Inputs at time t. t [s], tail [unknowns of the pulleys, and behind them integrals I of controllers [s] and the hydraulics', if there
    /// are any]
    [[nodiscard]] Inputs inputs(double t, const double* tail) const noexcept;
    /// Puts values in place of tables; between steps only.
    void hold(const HeldInputs& held) noexcept { held_ = held; }
    [[nodiscard]] const HeldInputs& held() const noexcept { return held_; }
    /// Angle and speed of what holds shaft 0 or 1 at time t: of a governor's reference, or of a coupling's far end. t [s]
    [[nodiscard]] double reference_angle(double t, int shaft) const noexcept;
    [[nodiscard]] double reference_speed(double t, int shaft) const noexcept;  ///< t [s]
    /// Couplings, and load mode speed, take over: with the twist that carries the torque that acts at this instant. Before, shaft 1 is held
    /// by the governor of mode speed and shaft 2 by load.torque. t [s], tail as inputs()
    void couple(double t, const double* tail) noexcept;
    /// Oil with which cylinders have the clamping forces that act at this instant; call it before couple(). t [s], tail as inputs()
    void fill_cylinders(double t, double* tail) const noexcept;
    /// Hydraulics at one instant, and their energies so far; zero without any or before they act. t [s], tail as inputs()
    [[nodiscard]] HydraulicInstant hydraulics(double t, const double* tail) const noexcept;
    [[nodiscard]] HydraulicEnergy hydraulic_energy(const double* tail) const noexcept;  ///< tail as inputs()
    /// Whether a coupling acts on shaft 0 or 1; its state, zero where none does. t [s], block [unknowns of the pulleys]
    [[nodiscard]] bool coupled(int shaft) const noexcept;
    [[nodiscard]] CouplingState coupling(double t, const double* block, int shaft) const noexcept;
    /// Slope [v | acceleration] of the pulleys' block. Losses and energies are added to the account if there is one.
    void slope(const double* block, const Inputs& inputs, const SheaveForces& chain, double* slope, Account* account) const noexcept;
    [[nodiscard]] WorkRates works(const double* block, const Inputs& inputs) const noexcept;  ///< block [unknowns of the pulleys]
    /// Elastic pulleys: springs and dampers of the bearings. Rigid ones: what holds shaft and sheaves against chain and cylinder.
    /// block [unknowns of the pulleys]
    [[nodiscard]] std::array<BearingLoad, 2> bearings(const double* block, const Inputs& inputs, const SheaveForces& chain) const noexcept;
    /// Work of constant inputs while the pulleys move from one position to another [J]. @param from, to blocks [q | v]
    [[nodiscard]] WorkRates work(const double* from, const double* to, const Inputs& inputs) const noexcept;
    /// Angular momentum of shaft 0 or 1 and its sheaves about the shaft's axis [N·m·s].
    [[nodiscard]] double momentum(const double* block, int shaft) const noexcept;
    /// Angle, speed of shaft 0 or 1; axial position of its movable sheave relative to its shaft.
    [[nodiscard]] double shaft_speed(const double* block, int shaft) const noexcept { return block[size_ + rotation(shaft)]; }
    /// block [unknowns of the pulleys]
    [[nodiscard]] double clamped_position(const double* block, int shaft) const noexcept { return opening(block, shaft); }
    /// Index of a shaft's rotation, and of its movable sheave's axial motion, in the pulleys' q.
    [[nodiscard]] int rotation(int shaft) const noexcept { return elastic() ? body_freedom(shaft, 5) : shaft; }
    [[nodiscard]] int sheave_rotation(int shaft, int side) const noexcept {
        return elastic() ? body_freedom(sheave_body(shaft, side), 5) : shaft;
    }
    [[nodiscard]] int movable(int shaft) const noexcept { return elastic() ? body_freedom(movable_body(shaft), 4) : 2 + shaft; }
    [[nodiscard]] double inertia(int coordinate) const noexcept { return inertia_[static_cast<std::size_t>(coordinate)]; }
    /// Adds losses and energies of supports, cylinders and motion. block [unknowns of the pulleys]
    void account(const double* block, Account& account) const noexcept;
    /// Kinetic energy of the pulleys [J].
    [[nodiscard]] double kinetic(const double* block) const noexcept;

private:
    /// A deflection u = Σ factor·q over at most three coordinates, with its spring.
    struct Support {
        std::array<int, 3> index;
        std::array<double, 3> factor;
        Spring spring;
        std::size_t terms;  ///< factors in front of the zeros
    };
    [[nodiscard]] bool elastic() const noexcept { return size_ == 36; }
    /// Side that moves: +z on the driving shaft, -z on the driven one; its sign.
    [[nodiscard]] static int movable_body(int shaft) noexcept { return sheave_body(shaft, shaft == 0 ? 1 : 0); }
    [[nodiscard]] static double movable_side(int shaft) noexcept { return shaft == 0 ? 1.0 : -1.0; }
    /// w of the movable sheave relative to its shaft, of positions or velocities.
    [[nodiscard]] double opening(const double* coordinates, int shaft) const noexcept;
    /// Whether it is the sheave that imperfections name.
    [[nodiscard]] bool imperfect(int shaft, int side) const noexcept { return 2 * shaft + side == static_cast<int>(imperfection_.sheave); }
    /// Displacement of an eccentric flank, at the angle of its sheave, and its derivative by the angle [m].
    [[nodiscard]] std::array<double, 2> eccentricity(double angle) const noexcept;
    void add_inertia();
    void add_bearings(int shaft);
    void add_attachment(int shaft, int side);
    void spring(std::array<int, 3> index, std::array<double, 3> factor, double stiffness, double mass);  ///< stiffness [N/m], mass [kg]
    /// block [unknowns of the pulleys], force [N, N·m]
    void add_supports(const double* block, double* force, Account* account) const noexcept;
    void add_gyroscopic(const double* v, double* force) const noexcept;  ///< v [velocities of the pulleys], force [N, N·m]
    /// block [unknowns of the pulleys], force [N, N·m]
    void add_clamping(const double* block, const Inputs& inputs, double* force, Account* account) const noexcept;
    /// block [unknowns of the pulleys], force [N, N·m]
    void add_chain(const double* block, const SheaveForces& chain, double* force) const noexcept;
    [[nodiscard]] double drive_torque(double t, const double* block) const noexcept;  ///< t [s], block [unknowns of the pulleys]
    /// By what holds a shaft by its angle and speed [N·m]. t [s], block [unknowns of the pulleys]
    [[nodiscard]] double holding_torque(const Spring& by, double t, const double* block, int shaft) const noexcept;
    [[nodiscard]] double resisting_torque(double t, const double* block) const noexcept;  ///< against shaft 2. t [s], block as above
    [[nodiscard]] const TimeTable& speed_table(int shaft) const noexcept { return shaft == 0 ? drive_.speed : load_.speed; }
    [[nodiscard]] const std::optional<double>& held_speed(int shaft) const noexcept {
        return shaft == 0 ? held_.drive_speed : held_.load_speed;
    }
    /// [N]. table: S_2(t) [N], load: M [N·m], block [unknowns of the pulleys]
    [[nodiscard]] double driven_clamping(double table, double load, const double* block) const noexcept;
    /// Clamping forces before limits and controllers: of the tables or a host; by pressures where these are requested. now ≥ 0 [s]
    [[nodiscard]] std::array<double, 2> given_clamping(double now, const double* tail) const noexcept;  ///< tail as inputs()
    [[nodiscard]] Inputs requested(double t, const double* tail) const noexcept;                        ///< as inputs(), before hydraulics
    [[nodiscard]] bool hydraulics_act() const noexcept { return hydraulics_.present() && held_.coupled && size_ != 0; }
    [[nodiscard]] HydraulicInstant hydraulics_of(double t, const double* tail, const Inputs& requested) const noexcept;
    [[nodiscard]] const double* oil(const double* tail) const noexcept { return tail + 2 * size_ + controllers_; }
    [[nodiscard]] CylinderMotion cylinder_motion(const double* block, int shaft) const noexcept;  ///< block [unknowns of the pulleys]
    /// One of the machine's controllers: what it holds, by which clamping force, and its gains.
    struct Governing {
        ControlledQuantity quantity = ControlledQuantity::ratio;
        std::size_t shaft = 0;
        double proportional = 0.0, integral = 0.0, authority = 0.0;  ///< [N, N/s, N]
    };
    void add_controllers();
    void add_holders();
    /// Error of what a controller holds [1]; `built_up` is the force of its shaft without its proportional part [N].
    [[nodiscard]] double control_error(const Governing& by, double now, double load, double built_up, const double* block) const noexcept;
    [[nodiscard]] BearingLoad sprung_bearing(const double* block, int shaft) const noexcept;  ///< block [unknowns of the pulleys]
    /// block [unknowns of the pulleys]
    [[nodiscard]] BearingLoad held_bearing(const double* block, int shaft, const Inputs& inputs, const SheaveForces& chain) const noexcept;

    Pulley pulley_;
    Imperfection imperfection_;
    Drive drive_;
    Load load_;
    Clamping clamping_;
    Control control_;
    int controllers_ = 0;
    std::array<Governing, 2> governing_;
    HydraulicModel hydraulics_;
    Start start_;
    HeldInputs held_;
    int size_;
    double half_length_;           ///< ℓ_p/2, distance of a flank plane from the middle [m]
    double gripping_;              ///< 2μ/cos β, tangential force that a pulley can carry per clamping force [1]
    double narrowing_;             ///< 1/(2 tan β), loss of running radius per opening of the groove [1]
    std::vector<double> inertia_;  ///< diagonal [kg, kg·m²]
    std::vector<Support> supports_;
    std::array<Spring, 2> governor_, holder_;  ///< of each shaft: as in mode speed; as its mode has it once couplings have taken over
    double reference_speed_;                   ///< [rad/s]
};

}  // namespace cvtflow::model
