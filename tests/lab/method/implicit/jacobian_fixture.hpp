#pragma once
/// The sparse Jacobian entry by entry, and its difference from a dense one.

#include <vector>

#include "settled_fixture.hpp"

namespace cvtflow::bench {

/// Entry of the sparse form in accelerations `row` and unknown `column` (links, then border) of one kind; 0 where there is none.
[[nodiscard]] double entry(const bench::AccelerationJacobian& jacobian, bench::With with, int row, int column);

/// How far, at most, the sparse form lies outside of two dense Jacobians of the whole state [column by column], relative to the largest
/// entry of the same kind in the same part (links on links, links on pulleys, pulleys on links, pulleys on pulleys).
[[nodiscard]] double largest_difference(const model::ChainLayout& layout, const bench::AccelerationJacobian& jacobian,
                                        const std::vector<double>& dense, const std::vector<double>& other);

}  // namespace cvtflow::bench
