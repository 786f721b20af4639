#pragma once
/// Rule of phase changes of a tip: thresholds with hysteresis, as functions whose sign changes at the transition.
/// A tip that would flip back at once stays.

#include "model/parameters/chain_layout.hpp"

namespace cvtflow::model {

/// Quantities that determine the phase of one tip.
struct TipIndicator {
    double depth;  ///< δ [m]
    double slip;   ///< |v_t| [m/s]
    bool operator==(const TipIndicator&) const = default;
};

/// Thresholds of the phases. The contact law itself is continuous at δ = 0, so a small band costs nothing:
/// a touching tip with a gap carries no force, and a tip leaves only when the gap exceeds `release`.
struct PhaseRule {
    double release = 1e-9;          ///< gap at which a touching tip becomes free [m]
    double slip_band = 1e-6;        ///< relative width of the band about v0 between stick and slip
    double saturation_speed = 1.0;  ///< v0 of the tips [m/s]
    bool stick_slip = false;        ///< whether stick and slip are phases

    /// Phase that the tip should have, given that it has `phase` now.
    [[nodiscard]] Phase next(Phase phase, const TipIndicator& tip) const noexcept {
        if (phase == Phase::free) return tip.depth > 0.0 ? touching(tip) : Phase::free;
        if (tip.depth < -release) return Phase::free;
        if (phase == Phase::stick && tip.slip > saturation_speed * (1.0 + slip_band)) return Phase::slip;
        if (phase == Phase::slip && tip.slip < saturation_speed * (1.0 - slip_band)) return Phase::stick;
        return phase;
    }
    /// Continuous function of the tip that becomes positive where the transition from `phase` to `to` is due.
    [[nodiscard]] double due(Phase phase, Phase to, const TipIndicator& tip) const noexcept {
        if (phase == Phase::free) return tip.depth;
        if (to == Phase::free) return -release - tip.depth;
        return to == Phase::slip ? tip.slip - saturation_speed * (1.0 + slip_band) : saturation_speed * (1.0 - slip_band) - tip.slip;
    }

private:
    [[nodiscard]] Phase touching(const TipIndicator& tip) const noexcept {
        if (!stick_slip) return Phase::touching;
        return tip.slip > saturation_speed ? Phase::slip : Phase::stick;
    }
};

}  // namespace cvtflow::model
