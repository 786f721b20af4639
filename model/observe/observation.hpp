#pragma once
/// Observed quantities of one instant: speeds, torques, tensions, forces, energies and powers.

#include <array>
#include <variant>
#include <vector>

#include "model/observe/chain_forces.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::model {

/// Forces of an instant that are evaluated on demand.
struct ForceObservation {
    ChainForces chain;
    std::array<BearingLoad, 2> bearing{};  ///< load of the shafts on the housing
    double misalignment = 0.0;             ///< offset of the middles of the two grooves along z: driving minus driven [m]
};

/// Sums over the tips of each pulley. Sliding along the circumference at speed v_θ, on radius r, against a sheave.
struct Creep {
    std::array<double, 2> hold{};  ///< Σ μ N g r²: moment of friction on the shaft per speed of the shaft [N·m·s]
    std::array<double, 2> drag{};  ///< Σ μ N g r v_θ: moment of friction on the shaft [N·m]
    double power = 0.0;            ///< Σ μ N g v_θ², of both pulleys: lost by sliding along the circumference, ≥ 0 [W]
};

/// Guide of a strand.
struct GuideLoad {
    double force = 0.0;       ///< sum of the normal forces of its rails [N]
    double deflection = 0.0;  ///< deflection of the pin between the rails that is farthest from their middle, outwards [m]
};

/// Quantities of an instant.
struct Observation {
    double time = 0.0;                        ///< [s]
    std::array<double, 2> speed{};            ///< shaft speeds [rad/s]
    std::array<double, 2> angle{};            ///< shaft angles [rad]
    std::array<double, 2> torque{};           ///< external torques on the shafts: drive, load (negative brakes) [N·m]
    std::array<double, 2> drag{};             ///< torques of seals, bearings and oil on the shafts, against a positive speed [N·m]
    std::array<double, 2> chain_torque{};     ///< torques of the chain on the sheaves of each shaft [N·m]
    std::array<double, 2> clamping{};         ///< S_1, S_2 [N]
    std::array<double, 2> radius{};           ///< mean running radius of the links that touch [m]
    std::array<double, 2> sheave_position{};  ///< w of the movable sheaves against their shafts [m]
    std::array<double, 4> axial_force{};      ///< sum over all tips on sheaves 1-, 1+, 2-, 2+ [N]
    double limit_use = 0.0;                   ///< largest ratio of a clamping force to wear.clamping_limit at its slip speed; 0: no limit
    bool control_limited = false;             ///< whether a controller demands more than its authority
    bool at_floor = false;                    ///< whether the table of shaft 2, and not clamping.safety, decides its clamping force
    ControlInstant control{};                 ///< first controller
    double ratio = 0.0;                       ///< ω_1/ω_2 [1]
    std::array<double, 2> pin_speed{};        ///< mean angular speed about the shaft's axis of the pins that touch [rad/s]
    std::array<double, 2> free_speed{};       ///< shaft speed without torque by friction: mean of pins, weighted by friction [rad/s]
    double slip = 0.0;           ///< 1 - (Ω_1/ω_1)(ω_2/Ω_2), Ω: pin_speed; creep or slip of the contacts on both pulleys together [1]
    double friction_slip = 0.0;  ///< 1 - (Ω°_1/ω_1)(ω_2/Ω°_2), Ω°: free_speed; zero without torque [1]
    Creep creep;
    double loss_slip = 0.0;           ///< ratio of creep.power to the power of the shafts that supply any; 0 if none does
    double chain_speed = 0.0;         ///< mean of |velocity| of the rear halves [m/s]
    double tight = 0.0, slack = 0.0;  ///< mean tension of the strand that shaft 1 pulls, and of the other (a ring: of all) [N]
    int touching = 0;                 ///< tips that are not free
    double deepest = 0.0;             ///< deepest penetration of a tip [m]
    std::vector<double> tension;      ///< [links] [N]
    std::vector<double> tip_axial;    ///< [4 links] axial force of each tip on its sheave [N]
    Account account;                  ///< energies and losses
    WorkRates work{};                 ///< powers of drive, load, clamping [W]
    HydraulicInstant hydraulics;      ///< zero without any
    HydraulicEnergy hydraulic_energy;
    /// Loads of the guides of both strands, in the order `tight`, `slack`; zero without guides.
    std::array<GuideLoad, 2> guide{};
};

/// Results of an evaluation of the whole chain for links of pin halves (ChainModel::observed_slopes and book_kinetic).
struct EvaluatedLinks {
    const LinkLoad* loads;        ///< [links]
    const Account* accounts;      ///< [links * account_parts]
    const LinkContact* contacts;  ///< [links]
};

/// Evaluates observations; owns their memory. Not for the step loop: serial. An observation of rigid pins whose forces are known reads
/// them, any other evaluates the chain: some tens of microseconds.
class Observer {
public:
    explicit Observer(const Variator& variator);
    /// Reads the whole state; the returned object is reused by the next call. @param t [s]   @param state [unknowns]
    /// @param evaluated results of an evaluation of that state; nullptr: the observer evaluates pin halves itself, with equal bits
    const Observation& observe(double t, const double* state, const Phase* phases, const EvaluatedLinks* evaluated = nullptr) noexcept;
    /// Reads rigid pins with the forces of their last step. Losses and energies are those that the step counts.
    const Observation& observe(double t, const RigidState& pins) noexcept;
    /// Reads the unknowns behind the links and evaluates no chain: time, speed, angle, torque, clamping, sheave_position, control_limited,
    /// ratio, work and hydraulics. Other members keep earlier values. @param t [s]   @param behind [unknowns behind the links]
    const Observation& observe_shafts(double t, const double* behind) noexcept;
    /// Forces of the instant observed last, whose state must still exist; evaluated on first use.
    const ForceObservation& forces();

private:
    void begin(double t) noexcept;                                                                    ///< t [s]
    [[nodiscard]] EvaluatedLinks evaluate_halves(const double* state, const Phase* phases) noexcept;  ///< state [unknowns]
    /// @param state [unknowns]
    void observe_halves(const double* state, const Phase* phases, const EvaluatedLinks& evaluated) noexcept;
    void observe_links(const double* state, const Phase* phases) noexcept;    ///< reads halves. state [unknowns]
    void observe_strands(const double* state, const Phase* phases) noexcept;  ///< reads halves. state [unknowns]
    void observe_radii(const double* state, const Phase* phases) noexcept;    ///< reads halves. state [unknowns]
    void observe_rigid(const auto& now) noexcept;
    void read_shafts(const double* behind) noexcept;  ///< reads shafts at observation_.time. behind [unknowns behind the links]
    void observe_pulleys() noexcept;
    /// A pin, or a part of one, at the guides. @param part ½ for a half   @param x, y [m]   @param vx, vy [m/s]
    void observe_guide(double part, double x, double y, double vx, double vy) noexcept;
    void observe_slip() noexcept;  ///< needs creep and pulleys

    const Variator& variator_;
    EvaluationScratch scratch_;
    std::vector<double> slope_;          ///< [unknowns of the links, per second]
    std::vector<LinkContact> contacts_;  ///< [links] from evaluate_halves()
    const LinkContact* seen_ = nullptr;  ///< [links] of the halves observed last
    std::vector<double> tail_;           ///< [unknowns behind the pins] for rigid pins outside a state
    SheaveForces sheave_forces_{};       ///< forces of the chain
    Observation observation_;
    ForceObservation forces_;
    const double* state_ = nullptr;    ///< state observed last; nullptr: rigid pins outside a state [unknowns]
    const double* pulleys_ = nullptr;  ///< pulleys' block of the instant observed last; nullptr: none
    /// Rigid pins observed last: none, those of a state, those of a step.
    std::variant<std::monostate, RigidInstantOf<double>, RigidInstantOf<float>> rigid_;
    bool forces_known_ = false;  ///< whether forces_ belongs to the instant observed last
};

}  // namespace cvtflow::model
