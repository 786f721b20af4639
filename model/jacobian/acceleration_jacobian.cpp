#include "model/jacobian/acceleration_jacobian.hpp"

namespace cvtflow::model {

AccelerationJacobian::AccelerationJacobian(const ChainLayout& layout)
    : links_(layout.links), size_(layout.link_size()), border_(layout.pulley_size + (layout.control ? 1 : 0)) {
    const auto numbers = [](int count) { return std::vector<double>(static_cast<std::size_t>(count), 0.0); };
    link_ = numbers(6 * links_ * size_ * size_);
    columns_ = numbers(2 * links_ * size_ * border_);
    rows_ = columns_;
    corner_ = numbers(2 * border_ * border_);
}

}  // namespace cvtflow::model
