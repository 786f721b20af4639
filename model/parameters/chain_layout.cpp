#include "model/parameters/chain_layout.hpp"

#include <cmath>

namespace cvtflow::model {

ChainLayout layout_of(const Parameters& parameters) noexcept {
    const auto pulley_size = [&] {
        switch (parameters.detail.pulleys) {
            case PulleyDetail::elastic: return 36;
            case PulleyDetail::rigid: return 4;
            case PulleyDetail::absent: break;
        }
        return 0;
    }();
    const bool has_pulleys = pulley_size != 0;
    const int hydraulics = parameters.hydraulics.mode != HydraulicMode::none ? hydraulic_unknowns : 0;
    const bool rigid = parameters.detail.pins == PinDetail::rigid;
    return {parameters.chain.pins, pulley_size, has_pulleys ? controllers(parameters.control) + hydraulics : 0, parameters.ledger, rigid};
}

double pin_period(const Chain& chain, const ChainLayout& at, const double* state) noexcept {
    double speed = 0.0;
    for (int link = 0; link < at.links; ++link) {
        const double* v = state + at.link_begin(link) + at.link_size();
        const double vx = v[at.x(End::rear, 0)], vy = v[at.y(End::rear, 0)];
        speed += std::sqrt(vx * vx + vy * vy);
    }
    return speed > 0.0 ? chain_length(chain) / speed : 0.0;
}

}  // namespace cvtflow::model
