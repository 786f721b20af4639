#include "model/parameters/chain_layout.hpp"

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
    return {rigid ? 2 : parameters.detail.order,
            parameters.chain.pins,
            pulley_size,
            has_pulleys ? controllers(parameters.control) + hydraulics : 0,
            parameters.ledger,
            rigid};
}

}  // namespace cvtflow::model
