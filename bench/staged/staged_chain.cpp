#include "bench/staged/staged_chain.hpp"

#include <algorithm>
#include <stdexcept>

namespace cvtflow::bench {

StagedBuffers::StagedBuffers(const model::ChainLayout& layout)
    : joint_stride(2 * layout.lateral() + 4), tip_stride(layout.link_size() + 1) {
    const std::size_t links = static_cast<std::size_t>(layout.links);
    joints.resize(links * static_cast<std::size_t>(joint_stride));
    tips.resize(links * static_cast<std::size_t>(tip_stride));
    moments.resize(links);
}

StagedFunctions staged_functions(const ChainModel& model, bool observe) {
    const std::vector<CompiledStages> compiled = compiled_stages();
    const auto row = std::ranges::find(compiled, model.isa(), &CompiledStages::isa);
    if (row == compiled.end()) throw std::logic_error("stages are not compiled for the model's instruction set");
    return row->functions(model.layout().order, observe);
}

}  // namespace cvtflow::bench
