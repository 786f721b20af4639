#include "bench/method/linear/block_chain.hpp"

#include <algorithm>

#include "bench/method/linear/dense.hpp"

namespace cvtflow::bench {

namespace {

[[nodiscard]] std::vector<double> zeros(int count) { return std::vector<double>(static_cast<std::size_t>(count), 0.0); }

}  // namespace

BlockChain::BlockChain(int count, int size, int border)
    : count_(count),
      size_(size),
      border_(border),
      lower_(zeros(count * size * size)),
      diagonal_(lower_),
      panel_(zeros(count * size * (2 * size + border))),
      outer_(zeros(count * (size + border) * size)),
      exchanges_(static_cast<std::size_t>(count * size)),
      right_lower_(zeros(size * size)),
      left_upper_(right_lower_),
      right_row_(zeros(size * (2 * size + border))),
      outer_sum_(zeros((size + border) * (2 * size + border))),
      right_part_(zeros(size)),
      outer_part_(zeros(size + border)),
      solution_(zeros(count * size)) {}

void BlockChain::clear(int active) noexcept {
    active_ = active;
    for (std::vector<double>* all : {&lower_, &diagonal_, &panel_, &outer_, &right_lower_, &left_upper_})
        std::fill(all->begin(), all->end(), 0.0);
}

BlockChain::Rows BlockChain::block(int i) noexcept {
    double* wide = panel(i);
    return {lower(i), diagonal(i), wide, wide + 2 * size_, outer(i) + size_ * size_, stride()};
}

/// Separators that are neighbours: their coupling is passed on as it is.
void BlockChain::close_without_interior() noexcept {
    for (int row = 0; row < size_; ++row) {
        std::copy_n(right_lower_.data() + row * size_, size_, right_row_.data() + row * stride() + size_);
        std::copy_n(left_upper_.data() + row * size_, size_, outer_sum_.data() + row * stride());
    }
}

/// Outer rows, once block i is expressed by its successors: E_i x_i leaves -E_i D⁻¹[U | left | C]; the first part goes to the next block.
void BlockChain::eliminate_outer(int i) noexcept {
    const int rows = size_ + active_;
    const double* own = outer(i);
    const bool last = i + 1 == count_;
    double* next = last ? outer_sum_.data() : outer(i + 1);
    subtract_product(rows, size_, size_, own, size_, panel(i), stride(), next, last ? stride() : size_);
    subtract_product(rows, size_, size_ + active_, own, size_, panel(i) + size_, stride(), outer_sum_.data() + size_, stride());
}

bool BlockChain::eliminate() noexcept {
    std::fill(right_row_.begin(), right_row_.end(), 0.0);
    std::fill(outer_sum_.begin(), outer_sum_.end(), 0.0);
    if (count_ == 0) {
        close_without_interior();
        return true;
    }
    std::copy(left_upper_.begin(), left_upper_.end(), outer(0));
    for (int row = 0; row < size_; ++row) std::copy_n(lower(0) + row * size_, size_, panel(0) + row * stride() + size_);
    for (int i = 0; i < count_; ++i) {
        double* wide = panel(i);
        if (i > 0) {
            subtract_product(size_, size_, size_, lower(i), size_, panel(i - 1), stride(), diagonal(i), size_);
            subtract_product(size_, size_, size_ + active_, lower(i), size_, panel(i - 1) + size_, stride(), wide + size_, stride());
        }
        int* exchanges = exchanges_.data() + i * size_;
        if (!factorise(size_, diagonal(i), exchanges)) return false;
        solve_factorised(size_, diagonal(i), exchanges, wide, stride(), stride());
        eliminate_outer(i);
    }
    subtract_product(size_, size_, stride(), right_lower_.data(), size_, panel(count_ - 1), stride(), right_row_.data(), stride());
    return true;
}

void BlockChain::forward(const double* f) noexcept {
    std::fill(right_part_.begin(), right_part_.end(), 0.0);
    std::fill(outer_part_.begin(), outer_part_.end(), 0.0);
    if (count_ == 0) return;
    std::copy_n(f, count_ * size_, solution_.data());
    for (int i = 0; i < count_; ++i) {
        double* own = solution_.data() + i * size_;
        if (i > 0) subtract_product(size_, size_, 1, lower(i), size_, own - size_, 1, own, 1);
        solve_factorised(size_, diagonal(i), exchanges_.data() + i * size_, own, 1, 1);
        subtract_product(size_ + active_, size_, 1, outer(i), size_, own, 1, outer_part_.data(), 1);
    }
    subtract_product(size_, size_, 1, right_lower_.data(), size_, solution_.data() + (count_ - 1) * size_, 1, right_part_.data(), 1);
}

void BlockChain::backward(const double* left, const double* right, const double* y, double* x) const noexcept {
    std::copy(solution_.begin(), solution_.end(), x);
    for (int i = count_ - 1; i >= 0; --i) {
        const double* wide = panel_.data() + i * size_ * (2 * size_ + border_);
        double* own = x + i * size_;
        subtract_product(size_, size_, 1, wide, stride(), i + 1 < count_ ? own + size_ : right, 1, own, 1);
        subtract_product(size_, size_, 1, wide + size_, stride(), left, 1, own, 1);
        subtract_product(size_, active_, 1, wide + 2 * size_, stride(), y, 1, own, 1);
    }
}

}  // namespace cvtflow::bench
