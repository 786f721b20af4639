#pragma once
/// Geometric start: a closed chain with every joint just touching (or pre-tensioned against the centrifugal pull), every plate at its
/// free length, sheaves just touching the tips, velocities of running without slip. (model/EQUATIONS.md)

#include <functional>
#include <utility>
#include <vector>

#include "model/machine/belt.hpp"
#include "model/parameters/chain_layout.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

struct StartState {
    std::vector<double> state;  ///< [layout.size()]
    std::vector<Phase> phases;  ///< [4 links], all free: the first step finds what touches
    BeltRadii radii;            ///< radii of the pitch path [m]
    double speed;               ///< speed of the chain [m/s]
};

/// State at the begin of settling. Throws std::invalid_argument if the chain does not close around the pulleys at the given ratio.
[[nodiscard]] StartState start_state(const Parameters& parameters);

/// Mass of one pitch of the chain [kg].
[[nodiscard]] double link_mass(const Parameters& parameters) noexcept;

using PathOf = std::function<PitchPath(double)>;  ///< path for a radius of the driving pulley (or ring)

/// Positions of both halves of every pin, and the pin's place on the path.
struct PlacedChain {
    std::vector<Point> front, rear;  ///< L_i, R_i
    std::vector<double> along;       ///< share of the way from the driving to the driven pulley
    double radius;                   ///< radius of the driving pulley or ring [m]
};

/// Chain closed on its path: pins at chord distances, joints rolling purely (arc centres along the bisector), links at the given lengths.
class ChainPlacer {
public:
    /// @param pretension force in plates and joints [N]   @param guess radius to begin the search with [m]
    ChainPlacer(const Parameters& parameters, double pretension, PathOf path_of, double guess);

    /// Throws std::invalid_argument if the chain cannot be closed.
    /// @param phase where pin 0 is on the path [m]   @param rise axial distance from the driving to the driven arc, climbed evenly along
    /// the strands [m]
    [[nodiscard]] PlacedChain place(double phase, double rise) const;

private:
    /// Radius for which the chords close, and the pins on that path. phase [m]
    [[nodiscard]] std::pair<std::vector<Point>, PlacedChain> close(const std::vector<double>& chord, double phase) const;
    /// Halves from pins; corrects chords and directions; returns the largest error of a link's length or direction [m].
    double relax(const std::vector<Point>& pins, double rise, std::vector<double>& chord, std::vector<Point>& direction,
                 PlacedChain& chain) const;

    PathOf path_of_;
    bool ring_;                   ///< whether there are no pulleys
    bool pitch_lines_;            ///< halves turn with the line between their pins, not with their link
    double guess_;                ///< [m]
    double arm_, diameter_;       ///< [m]
    std::vector<double> length_;  ///< lengths of the links [m]
};

}  // namespace cvtflow::model
