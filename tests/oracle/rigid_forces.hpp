#pragma once
/// Forces on rigid pins while they are added up (EQUATIONS.md, sections 10 and 11).

#include "tests/oracle/rigid_pins.hpp"

#include <vector>

namespace cvtflow::oracle {

struct PinForces {
    PinForces(const PinChain& chain, Totals& totals);

    const PinChain& chain;
    Totals& totals;
    std::vector<Real> moment;   ///< on pitch lines [N·m]
    std::vector<Real> thrust;   ///< Λ of plates' friction on the lengthening e of each pin [N]
    std::vector<Real> tension;  ///< T of each link [N]
    std::vector<Vec2> pull;     ///< f_i: of link i's deflections on its front half [N]

    /// A force on the middle of a half: virtual work on its pin's middle and on the directions on which the offset of the halves depends.
    void push(const PinHalf& half, Vec2 force, Real axial);
    void turn_lines();  ///< passes the moments to the pins
};

/// A tip that touches, with what follows from its place and motion alone.
struct PinTip {
    PinHalf half;
    TipContact contact;
    Real depth_rate;  ///< δ_0' [m/s]
    Real root;        ///< y, root of the depth that is Hertz's [√m]
    Real shortening;  ///< η: of half a pin, per depth
};
std::vector<PinTip> pressed_tips(const PinChain& chain);
/// e' of each pin [m/s].
std::vector<Real> lengthening_of(const PinChain& chain, const std::vector<PinTip>& tips);
void add_pin_tip(PinForces& forces, const PinTip& tip);

}  // namespace cvtflow::oracle
