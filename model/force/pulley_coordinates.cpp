#include "model/force/pulley_coordinates.hpp"

#include "model/basis/portable_math.hpp"

namespace cvtflow::model {

void PulleyCoordinates::adopt(const Parameters& p) noexcept {
    size_ = layout_of(p).pulley_size;
    arc_position_ = p.pulley.arc_position;
    narrowing_ = 0.5 * portable_cos(p.tip.angle) / portable_sin(p.tip.angle);
}

}  // namespace cvtflow::model
