#pragma once
/// Time in which a pin takes the place of the next one.

#include <cmath>

#include "model/parameters/chain_layout.hpp"
#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

/// Mean pitch over the mean speed of the rear pins; 0 of a chain at rest [s]. state [unknowns]
[[nodiscard]] inline double pin_period(const Chain& chain, const ChainLayout& at, const double* state) noexcept {
    double speed = 0.0;
    for (int link = 0; link < at.links; ++link) {
        const double* v = state + at.link_begin(link) + at.link_size();
        const double vx = v[at.x(End::rear, 0)], vy = v[at.y(End::rear, 0)];
        speed += std::sqrt(vx * vx + vy * vy);
    }
    return speed > 0.0 ? chain_length(chain) / speed : 0.0;
}

}  // namespace cvtflow::model
