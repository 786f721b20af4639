#include "bench/method/jacobian/acceleration_jacobian.hpp"

namespace cvtflow::bench {

AccelerationJacobian::AccelerationJacobian(const ChainLayout& layout)
    : links_(layout.links),
      size_(layout.link_size()),
      border_(layout.pulley_size + layout.controls),
      columns_begin_(6 * links_ * size_ * size_),
      rows_begin_(columns_begin_ + 2 * links_ * size_ * border_),
      corner_begin_(rows_begin_ + 2 * links_ * size_ * border_),
      numbers_(static_cast<std::size_t>(corner_begin_ + 2 * border_ * border_), 0.0) {}

}  // namespace cvtflow::bench
