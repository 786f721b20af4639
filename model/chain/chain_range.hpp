#pragma once
/// Ranges of links as kernels take them, and what they compute of a link.
///
/// A *window* holds the states of links first-1 … last (one neighbour on each side), contiguous, link_block() numbers each: all that the
/// evaluation of a range [first, last) of links depends on. With rigid pins it holds ChainLayout::halo() of them on each side.

#include "model/force/account.hpp"
#include "model/force/sheave_motion.hpp"
#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

/// Reaction of a link's tips on the sheaves of its pulley. Only written for links with a touching tip.
struct LinkLoad {
    SheaveLoad load;
    int shaft;  ///< 0 or 1: whose sheaves
};

/// A range of links and where its inputs are.
struct ChainRange {
    int first, last;              ///< [first, last)
    const double* window;         ///< states of links first-1 … last, or more by the layout's halo [m, m/s]
    const SheaveMotion* sheaves;  ///< [4] number 2 shaft + side; unused if the scene has no pulleys
    const Phase* phases;          ///< [links * 4], of the whole chain
    int shift = 1;                ///< column of a link in fields of contacts: its number + shift
    bool ghosts = true;           ///< the range fills ghost columns where it holds the link that they repeat, links + 1 and 0 for instance
};

/// Contact of one link's tips with its sheaves, for transitions and faults.
struct TipProbe {
    double depth[tips_per_link];  ///< δ [m], negative: gap
    double slip[tips_per_link];   ///< |v_t| [m/s], 0 if not requested
    double radius;                ///< distance of the link's middle from its shaft's axis [m]
};

/// Contact forces of a link, for observation. Tips are zero where none of the link's touches.
struct LinkContact {
    double tension;                ///< sum of its plates' elastic tensions [N]
    double depth[tips_per_link];   ///< δ [m], negative: gap
    double normal[tips_per_link];  ///< N [N]
    double axial[tips_per_link];   ///< force of each tip on its sheave along z [N]
};

/// The block of one link with the neighbours that contact of rigid pins depends on: one before, two behind. With pin halves it is the block
/// itself.
class NeighbourWindow {
public:
    /// @param state of the whole chain [unknowns]
    [[nodiscard]] const double* of(const ChainLayout& layout, const double* state, int link) noexcept;

private:
    static constexpr int before = 1, blocks = before + 3;
    double numbers_[blocks * max_link_block / 2];
};

}  // namespace cvtflow::model
