#pragma once
/// Springs and dampers between housing, shafts and sheaves of elastic pulleys. (model/EQUATIONS.md section 8)

#include <array>
#include <cstddef>
#include <vector>

#include "model/force/account.hpp"
#include "model/machine/coefficients.hpp"

namespace cvtflow::model {

/// What the bearings of a shaft carry: force and moment of the shaft on the housing.
struct BearingLoad {
    std::array<double, 3> force{};   ///< x, y, axial [N]
    std::array<double, 2> moment{};  ///< about x, y, at the middle of the shaft [N·m]
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

}  // namespace cvtflow::model
