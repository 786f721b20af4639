#pragma once
/// One whole pin and its tips, for observations.

#include "model/force/tip/tips.hpp"
#include "model/kernels/pins/pin_motion.hpp"

namespace cvtflow::model {
namespace {

/// One pin between its neighbours: where both of its tips are.
template <int P>
class PinAmongOthers {
public:
    using V = Lanes<1>;

    /// @param state block of the pin, with those of its neighbours beside it [unknowns]
    PinAmongOthers(const ChainModel& model, const double* state, const SheaveMotion* sheaves) noexcept
        : c_(model.coefficients()), motion_(c_.joint), shaft_(model.shaft_of(state)), sheaves_(sheaves + 2 * shaft_) {
        motion_.read(state - pin_at<P>.link_block(), 3);
        motion_.lines(0, 2);
        motion_.roll(1, 2);
        motion_.pin_as_link(1, columns_);
    }

    /// Calls body(side, geometry, motion) for both tips.
    template <class Body>
    void tips(const Body& body) const noexcept {
        tip(OneTip<1, End::rear, 0>{}, 0, body);
        tip(OneTip<1, End::rear, 1>{}, 1, body);
    }
    [[nodiscard]] int shaft() const noexcept { return shaft_; }

private:
    template <class Corner, class Body>
    void tip(const Corner& corner, int side, const Body& body) const noexcept {
        const auto own = sheaves_at(corner, sheaves_);
        const auto geometry = tip_geometry<P>(c_, corner, columns_.frame, columns_.q(), own);
        body(side, geometry, tip_motion<P>(c_, corner, columns_.frame, columns_.v(), own, geometry));
    }

    const Coefficients& c_;
    PinMotion<P, 1> motion_;
    LinkColumns<P, 1> columns_;
    int shaft_;
    const SheaveMotion* sheaves_;
};

}  // namespace
}  // namespace cvtflow::model
