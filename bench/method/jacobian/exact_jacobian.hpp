#pragma once
/// The Jacobian exactly, by forward differentiation where forces are made - at a plate, a point of a joint, a tip - and by the chain rule
/// from there to coordinates. At a kink, the side on which the state lies counts.

#include <array>
#include <vector>

#include "bench/method/jacobian/acceleration_jacobian.hpp"
#include "bench/method/product_names.hpp"
#include "model/variator/variator.hpp"

namespace cvtflow::bench {

/// Derivatives of a sheave's motion: x, y, z, tilts (positions), then their rates and the rotation's.
inline constexpr int sheave_directions = 11;
inline constexpr int sheave_positions = 5;

/// One tip's effect on its sheave, per motion of the sheave; row: force in the order of SheaveForces.
using SheaveStiffness = std::array<std::array<double, sheave_directions>, 6>;

class ExactJacobian {
public:
    /// @param variator must outlive this
    explicit ExactJacobian(const Variator& variator);

    /// Rows of the links [first, last): blocks, columns, and rows of the pulleys on them. Ranges are independent of each other. state
    /// [unknowns]
    void links(const double* state, const Phase* phases, int first, int last, AccelerationJacobian& out) noexcept;
    /// Pulleys and control on themselves, after all links: their own part by differences (supports and gyroscopic moments are polynomials
    /// of second degree, for which central differences are exact), the tips' part from what links() has left. t [s], state [unknowns]
    void corner(double t, const double* state, const Phase* phases, AccelerationJacobian& out) noexcept;

    /// Where a sheave's motion comes from and its loads go to; number 2 shaft + side.
    struct SheaveMap {
        std::array<int, sheave_directions> coordinate;  ///< pulley coordinate of each direction, -1: none
        struct Effect {
            int coordinate;
            double factor;  ///< acceleration per unit of load [1/kg or 1/(kg·m²)]
        };
        std::array<std::vector<Effect>, 6> effects;
    };
    [[nodiscard]] const SheaveMap& sheave(int number) const noexcept { return sheaves_[static_cast<std::size_t>(number)]; }

private:
    /// state [unknowns]
    using LinkFunction = void (*)(const ExactJacobian&, const Variator&, const double* state, const Phase* phases, int link,
                                  AccelerationJacobian&, SheaveStiffness*, const SheaveMotion*) noexcept;
    void find_maps();
    void own_corner(double t, const double* state, AccelerationJacobian& out) noexcept;  ///< t [s], state [unknowns]

    const Variator& variator_;
    LinkFunction link_;
    std::array<SheaveMap, 4> sheaves_;
    std::vector<SheaveStiffness> stiffness_;    ///< [links][side], summed over the ends
    std::vector<double> tail_, above_, below_;  ///< [unknowns of the pulleys] and their slopes
};

}  // namespace cvtflow::bench
