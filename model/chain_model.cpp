#include "model/chain_model.hpp"

#include "model/kernels/kernels.hpp"

namespace cvtflow::model {

ChainModel::ChainModel(const Parameters& parameters, Isa isa)
    : coefficients_(parameters), inertia_(link_inertia(parameters)), isa_(isa), kernels_(kernels_of(isa).chain(parameters.detail.order)) {}

}  // namespace cvtflow::model
