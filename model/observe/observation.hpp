#pragma once
/// Observed quantities of one instant: speeds, torques, tensions, forces, energies and powers.

#include <array>
#include <optional>
#include <vector>

#include "model/observe/chain_forces.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::model {

/// Forces of an instant that are evaluated on demand.
struct ForceObservation {
    ChainForces chain;
    std::array<BearingLoad, 2> bearing{};  ///< of the shafts on the housing
    double misalignment = 0.0;             ///< of the middles of the two grooves along z: driving minus driven [m]
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
    double deflection = 0.0;  ///< of the pin between the rails that is farthest from their middle, outwards [m]
};

/// Quantities of an instant.
struct Observation {
    double time = 0.0;                        ///< [s]
    std::array<double, 2> speed{};            ///< of the shafts [rad/s]
    std::array<double, 2> angle{};            ///< of the shafts [rad]
    std::array<double, 2> torque{};           ///< on the shafts from outside: drive, load (negative brakes) [N·m]
    std::array<double, 2> drag{};             ///< of seals, bearings and oil on the shafts, against a positive speed [N·m]
    std::array<double, 2> chain_torque{};     ///< of the chain on the sheaves of each shaft [N·m]
    std::array<double, 2> clamping{};         ///< S_1, S_2 [N]
    std::array<double, 2> radius{};           ///< mean running radius of the links that touch [m]
    std::array<double, 2> sheave_position{};  ///< w of the movable sheaves against their shafts [m]
    std::array<double, 4> axial_force{};      ///< of all tips on sheaves 1-, 1+, 2-, 2+ [N]
    double limit_use = 0.0;                   ///< largest clamping force over wear.clamping_limit at its slip speed; 0: no limit [1]
    bool control_limited = false;             ///< a controller asks for more than its authority
    ControlInstant control{};                 ///< of the first controller
    double ratio = 0.0;                       ///< ω_1/ω_2 [1]
    std::array<double, 2> pin_speed{};        ///< mean angular speed about the shaft's axis of the pins that touch [rad/s]
    std::array<double, 2> free_speed{};       ///< at which friction would put no torque on the shaft: pins weighted by it [rad/s]
    double slip = 0.0;           ///< 1 - (Ω_1/ω_1)(ω_2/Ω_2), Ω: pin_speed; creep or slip of the contacts on both pulleys together [1]
    double friction_slip = 0.0;  ///< 1 - (Ω°_1/ω_1)(ω_2/Ω°_2), Ω°: free_speed; zero without torque [1]
    Creep creep;
    double loss_slip = 0.0;           ///< creep.power over the power of those shafts that bring any; 0 where none does [1]
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
    /// Loads of the guides of both strands, as `tight` and `slack`; zero without guides.
    std::array<GuideLoad, 2> guide{};
};

/// Links of pin halves as an evaluation of the whole chain leaves them (ChainModel::observed_slopes and book_kinetic).
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
    /// @param evaluated what an evaluation of that state has left of pin halves; nullptr: the observer evaluates them itself, with equal
    /// bits
    const Observation& observe(double t, const double* state, const Phase* phases, const EvaluatedLinks* evaluated = nullptr) noexcept;
    /// Reads rigid pins with the forces of their last step, losses and energies of which are those that the step counts.
    const Observation& observe(double t, const RigidState& pins) noexcept;
    /// Reads what lies behind the links and evaluates no chain: time, speed, angle, torque, clamping, sheave_position, control_limited,
    /// ratio, work and hydraulics. All else is that of an earlier call. @param t [s]   @param behind [unknowns behind the links]
    const Observation& observe_shafts(double t, const double* behind) noexcept;
    /// Forces of the instant that was observed last, whose state must still be there; evaluated on first use.
    const ForceObservation& forces();

private:
    void begin(double t) noexcept;                                                                    ///< t [s]
    [[nodiscard]] EvaluatedLinks evaluate_halves(const double* state, const Phase* phases) noexcept;  ///< state [unknowns]
    /// @param state [unknowns]
    void observe_halves(const double* state, const Phase* phases, const EvaluatedLinks& evaluated) noexcept;
    void observe_links(const double* state, const Phase* phases) noexcept;    ///< of halves. state [unknowns]
    void observe_strands(const double* state, const Phase* phases) noexcept;  ///< of halves. state [unknowns]
    void observe_radii(const double* state, const Phase* phases) noexcept;    ///< of halves. state [unknowns]
    void observe_rigid(const RigidInstant& now) noexcept;
    void read_shafts(const double* behind) noexcept;  ///< at the time of the observation. behind [unknowns behind the links]
    void observe_pulleys() noexcept;
    /// A pin, or a part of one, at the guides. @param part ½ for a half   @param x, y [m]   @param vx, vy [m/s]
    void observe_guide(double part, double x, double y, double vx, double vy) noexcept;
    void observe_slip() noexcept;  ///< after the creep and the pulleys

    const Variator& variator_;
    EvaluationScratch scratch_;
    std::vector<double> slope_;          ///< [unknowns of the links, per second]
    std::vector<LinkContact> contacts_;  ///< [links] of evaluations of its own
    const LinkContact* seen_ = nullptr;  ///< [links] of the halves observed last
    std::vector<double> tail_;           ///< [unknowns behind the pins] where they are not in a state
    SheaveForces sheave_forces_{};       ///< of the chain
    Observation observation_;
    ForceObservation forces_;
    const double* state_ = nullptr;      ///< observed last; nullptr: rigid pins without one [unknowns]
    const double* pulleys_ = nullptr;    ///< their block of what was observed last; nullptr: nothing was
    std::optional<RigidInstant> rigid_;  ///< observed last
    bool forces_known_ = false;          ///< of the instant observed last
};

}  // namespace cvtflow::model
