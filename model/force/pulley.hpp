#pragma once
/// Shafts and sheaves: motion, inertia, forces and energies; springs and dampers between housing, shafts and sheaves of elastic pulleys.
/// (model/EQUATIONS.md section 8)

#include <array>
#include <cstddef>
#include <vector>

#include "model/force/account.hpp"
#include "model/force/pulley_inputs.hpp"
#include "model/force/sheave_motion.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {

/// Load on the bearings of a shaft: force and moment of the shaft on the housing.
struct BearingLoad {
    std::array<double, 3> force{};   ///< x, y, axial [N]
    std::array<double, 2> moment{};  ///< moment about x, y, at the middle of the shaft [N·m]
};

class ShaftSupports {
public:
    /// Becomes the supports of other parameters; rigid pulleys have none.
    void adopt(const Parameters& parameters);

    /// Adds forces, and losses and energies if there is an account. q, v [coordinates of the pulleys], force [N, N·m]
    void add(const double* q, const double* v, double* force, Account* account) const noexcept;
    /// Springs and dampers of the bearings of a shaft. q, v [coordinates of the pulleys]
    [[nodiscard]] BearingLoad bearing(const double* q, const double* v, int shaft) const noexcept;

private:
    /// A deflection u = Σ factor·q over at most three coordinates, with its spring.
    struct Support {
        std::array<int, 3> index;
        std::array<double, 3> factor;
        Spring spring;
        std::size_t terms;  ///< factors in front of the zeros
    };
    void add_bearings(const Pulley& pulley, int shaft);
    void add_attachment(const Parameters& parameters, int shaft, int side);
    /// stiffness [N/m], mass [kg]
    void spring(std::array<int, 3> index, std::array<double, 3> factor, double stiffness, double mass);

    double damping_ratio_ = 0.0;
    std::vector<Support> supports_;
};

/// Generalized forces of the chain on the four sheaves, number 2 shaft + side: (F_x, F_y, M_τx, M_τy, F_z, M_φ).
using SheaveForces = std::array<std::array<double, 6>, 4>;

/// Powers of the inputs [W].
using WorkRates = std::array<double, work_kinds>;

/// Powers of the inputs in a state. block [unknowns of the pulleys]
[[nodiscard]] WorkRates input_powers(const PulleyCoordinates& at, const double* block, const Inputs& inputs) noexcept;
/// Work of constant inputs while the pulleys move from one position to another [J]. @param from, to blocks [q | v]
[[nodiscard]] WorkRates input_work(const PulleyCoordinates& at, const double* from, const double* to, const Inputs& inputs) noexcept;

class PulleyModel {
public:
    explicit PulleyModel(const Parameters& parameters);
    /// Becomes the model of other parameters, inputs released; allocates only what does not fit into the memory it has.
    void adopt(const Parameters& parameters);

    [[nodiscard]] const PulleyCoordinates& coordinates() const noexcept { return inputs_.coordinates(); }
    [[nodiscard]] const ShaftTorques& torques() const noexcept { return inputs_.torques(); }
    [[nodiscard]] ShaftTorques& torques() noexcept { return inputs_.torques(); }
    [[nodiscard]] const PulleyInputs& inputs() const noexcept { return inputs_; }
    /// Whether a flank moves as its shaft turns.
    [[nodiscard]] bool eccentric() const noexcept { return imperfection_.runout != 0.0; }
    /// Positions and velocities of the four sheaves from the pulleys' block [q | v].
    void motions(const double* block, SheaveMotion* sheaves) const noexcept;
    /// Slope [v | acceleration] of the pulleys' block. Losses and energies are added to the account if there is one.
    void slope(const double* block, const Inputs& inputs, const SheaveForces& chain, double* slope, Account* account) const noexcept;
    /// Elastic pulleys: springs and dampers of the bearings. Rigid ones: what holds shaft and sheaves against chain and cylinder.
    /// block [unknowns of the pulleys]
    [[nodiscard]] std::array<BearingLoad, 2> bearings(const double* block, const Inputs& inputs, const SheaveForces& chain) const noexcept;
    /// Angular momentum of shaft 0 or 1 and its sheaves about the shaft's axis [N·m·s].
    [[nodiscard]] double momentum(const double* block, int shaft) const noexcept;
    [[nodiscard]] double inertia(int coordinate) const noexcept { return inertia_[static_cast<std::size_t>(coordinate)]; }
    /// Adds losses and energies of supports, cylinders and motion. block [unknowns of the pulleys]
    void account(const double* block, Account& account) const noexcept;
    /// Kinetic energy of the pulleys [J].
    [[nodiscard]] double kinetic(const double* block) const noexcept;

private:
    using enum PulleyCoordinates::Freedom;

    /// Displacement of an eccentric flank, at the angle of its sheave [m].
    [[nodiscard]] std::array<double, 2> eccentricity(double angle) const noexcept;
    /// Forces on the sheave with unbalance become such that the diagonal of its inertia gives its accelerations.
    void add_unbalance(const double* block, double* force) const noexcept;
    /// @param added to each shaft by drive and load [kg·m²]
    void add_inertia(const std::array<double, 2>& added);
    void add_gyroscopic(const double* v, double* force) const noexcept;  ///< v [velocities of the pulleys], force [N, N·m]
    /// block [unknowns of the pulleys], force [N, N·m]
    void add_clamping(const double* block, const Inputs& inputs, double* force, Account* account) const noexcept;
    /// block [unknowns of the pulleys], force [N, N·m]
    void add_chain(const double* block, const SheaveForces& chain, double* force) const noexcept;
    /// block [unknowns of the pulleys]
    [[nodiscard]] BearingLoad held_bearing(const double* block, int shaft, const Inputs& inputs, const SheaveForces& chain) const noexcept;

    PulleyInputs inputs_;
    Pulley pulley_;
    Imperfection imperfection_;
    double half_length_ = 0.0;     ///< ℓ_p/2, distance of a flank plane from the middle [m]
    std::vector<double> inertia_;  ///< diagonal [kg, kg·m²]
    ShaftSupports supports_;
};

}  // namespace cvtflow::model
