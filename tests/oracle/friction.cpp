#include "tests/oracle/friction.hpp"

#include <algorithm>

namespace cvtflow::oracle {

Real saturation(const model::Detail& detail, Real u) {
    if (detail.friction == model::FrictionLaw::piecewise) return std::min(u, 1.0L);
    const Real d = detail.smoothing;
    if (u <= 1.0L - d) return u;
    if (u >= 1.0L + d) return 1.0L;
    return 1.0L - (1.0L + d - u) * (1.0L + d - u) / (4.0L * d);
}

Real friction_slope(const model::Detail& detail, const model::Friction& friction, Real speed) {
    const Real v0 = friction.saturation_speed;
    if (speed == 0.0L) return 1.0L / v0;
    return saturation(detail, speed / v0) / speed;
}

}  // namespace cvtflow::oracle
