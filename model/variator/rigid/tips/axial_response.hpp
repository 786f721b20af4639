#pragma once
/// How the tips' force along z on the halves of a pin changes as they move. (model/EQUATIONS.md section 11)

#include "model/variator/rigid/tips/rigid_tip.hpp"

namespace cvtflow::model {
namespace {

/// Of both tips of a half, over the stiffness of a tip per η.
template <int W>
struct AxialResponse {
    Lanes<W> stiffness{0.0};  ///< against moving along z
    Lanes<W> loading{0.0};    ///< rate of change of the force [m/s]

    /// @param rate δ_0' [m/s]
    [[gnu::always_inline]] void add(const TipPlace<W>& tip, const NormalForce<W>& n, const Lanes<W>& rate) noexcept {
        stiffness += n.shortening * (tip.in * tip.in);
        loading += n.shortening * (rate * tip.normal_z);
    }
    /// Rate of change if the half stood still along z. @param speed of the half along z [m/s]
    [[nodiscard, gnu::always_inline]] Lanes<W> loading_at_rest(const Lanes<W>& speed) const noexcept { return loading + stiffness * speed; }
};

}  // namespace
}  // namespace cvtflow::model
