#include "model/kernels/staged/staged_chain.hpp"

#include "model/kernels/kernels.hpp"

namespace cvtflow::model {

StagedBuffers::StagedBuffers(const ChainLayout& layout) : joint_stride(2 * layout.lateral() + 4), tip_stride(layout.link_size() + 1) {
    const std::size_t links = static_cast<std::size_t>(layout.links);
    joints.resize(links * static_cast<std::size_t>(joint_stride));
    tips.resize(links * static_cast<std::size_t>(tip_stride));
    moments.resize(links);
}

StagedFunctions staged_functions(const ChainModel& model, bool observe) {
    return kernels_of(model.isa()).staged(model.layout().order, observe);
}

}  // namespace cvtflow::model
