#include "bench/method/linear/cyclic_border.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cvtflow::bench {

namespace {

/// c -= a_0 b_0 + … of `inner` rows of B, four at a time, each product subtracted by itself.
void subtract_rows(int inner, int columns, const double* __restrict a, const double* b, int b_stride, double* __restrict c) noexcept {
    int k = 0;
    for (; k + 4 <= inner; k += 4) {
        const double* __restrict b0 = b + k * b_stride;
        const double* __restrict b1 = b0 + b_stride;
        const double* __restrict b2 = b1 + b_stride;
        const double* __restrict b3 = b2 + b_stride;
        const double a0 = a[k], a1 = a[k + 1], a2 = a[k + 2], a3 = a[k + 3];
        for (int j = 0; j < columns; ++j) c[j] = (((c[j] - a0 * b0[j]) - a1 * b1[j]) - a2 * b2[j]) - a3 * b3[j];
    }
    for (; k < inner; ++k) {
        const double* __restrict row = b + k * b_stride;
        const double factor = a[k];
        for (int j = 0; j < columns; ++j) c[j] -= factor * row[j];
    }
}

[[nodiscard]] int largest_below(int size, const double* a, int k) noexcept {
    int best = k;
    for (int row = k + 1; row < size; ++row) {
        if (std::abs(a[row * size + k]) > std::abs(a[best * size + k])) best = row;
    }
    return best;
}

}  // namespace

void subtract_product(int rows, int inner, int columns, const double* a, int a_stride, const double* b, int b_stride, double* c,
                      int c_stride) noexcept {
    for (int row = 0; row < rows; ++row) subtract_rows(inner, columns, a + row * a_stride, b, b_stride, c + row * c_stride);
}

bool factorise(int size, double* a, int* exchanges) noexcept {
    for (int k = 0; k < size; ++k) {
        const int pivot = largest_below(size, a, k);
        exchanges[k] = pivot;
        if (pivot != k) std::swap_ranges(a + k * size, a + (k + 1) * size, a + pivot * size);
        const double head = a[k * size + k];
        if (!(std::abs(head) > 0.0) || !std::isfinite(head)) return false;
        for (int row = k + 1; row < size; ++row) {
            double* __restrict current = a + row * size;
            const double* __restrict top = a + k * size;
            const double factor = current[k] / head;
            current[k] = factor;
            for (int j = k + 1; j < size; ++j) current[j] -= factor * top[j];
        }
    }
    return true;
}

void solve_factorised(int size, const double* lu, const int* exchanges, double* x, int stride, int columns) noexcept {
    for (int k = 0; k < size; ++k) {
        if (exchanges[k] != k) std::swap_ranges(x + k * stride, x + k * stride + columns, x + exchanges[k] * stride);
    }
    for (int row = 1; row < size; ++row) subtract_rows(row, columns, lu + row * size, x, stride, x + row * stride);
    for (int row = size - 1; row >= 0; --row) {
        double* target = x + row * stride;
        subtract_rows(size - 1 - row, columns, lu + row * size + row + 1, x + (row + 1) * stride, stride, target);
        const double inverse = 1.0 / lu[row * size + row];
        for (int j = 0; j < columns; ++j) target[j] *= inverse;
    }
}

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
    const double* outer_block = outer(i);
    const bool last = i + 1 == count_;
    double* next = last ? outer_sum_.data() : outer(i + 1);
    subtract_product(rows, size_, size_, outer_block, size_, panel(i), stride(), next, last ? stride() : size_);
    subtract_product(rows, size_, size_ + active_, outer_block, size_, panel(i) + size_, stride(), outer_sum_.data() + size_, stride());
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
        double* of_block = solution_.data() + i * size_;
        if (i > 0) subtract_product(size_, size_, 1, lower(i), size_, of_block - size_, 1, of_block, 1);
        solve_factorised(size_, diagonal(i), exchanges_.data() + i * size_, of_block, 1, 1);
        subtract_product(size_ + active_, size_, 1, outer(i), size_, of_block, 1, outer_part_.data(), 1);
    }
    subtract_product(size_, size_, 1, right_lower_.data(), size_, solution_.data() + (count_ - 1) * size_, 1, right_part_.data(), 1);
}

void BlockChain::backward(const double* left, const double* right, const double* y, double* x) const noexcept {
    std::copy(solution_.begin(), solution_.end(), x);
    for (int i = count_ - 1; i >= 0; --i) {
        const double* wide = panel_.data() + i * size_ * (2 * size_ + border_);
        double* of_block = x + i * size_;
        subtract_product(size_, size_, 1, wide, stride(), i + 1 < count_ ? of_block + size_ : right, 1, of_block, 1);
        subtract_product(size_, size_, 1, wide + size_, stride(), left, 1, of_block, 1);
        subtract_product(size_, active_, 1, wide + 2 * size_, stride(), y, 1, of_block, 1);
    }
}

namespace {

/// into[row_of[i], column_of[j]] += part[i, j]; an empty map is the identity.
void add(int rows, int columns, const double* part, int stride, double* into, int into_stride, std::span<const int> row_of = {},
         std::span<const int> column_of = {}) noexcept {
    for (int i = 0; i < rows; ++i) {
        double* row = into + into_stride * (row_of.empty() ? i : row_of[static_cast<std::size_t>(i)]);
        for (int j = 0; j < columns; ++j) row[column_of.empty() ? j : column_of[static_cast<std::size_t>(j)]] += part[i * stride + j];
    }
}

}  // namespace

CyclicBorder::CyclicBorder(int blocks, int size, int border, int chunks)
    : blocks_(blocks),
      size_(size),
      border_(border),
      active_(static_cast<std::size_t>(chunks * border)),
      active_count_(static_cast<std::size_t>(chunks)),
      all_border_(static_cast<std::size_t>(border)),
      separators_(zeros(chunks * size * (size + 2 * border))),
      ring_(chunks - 1, size, border),
      corner_(zeros(border * border)),
      matrix_(zeros((size + border) * (size + border))),
      exchanges_(static_cast<std::size_t>(size + border)),
      known_(zeros(chunks * size + border)),
      seen_(zeros(chunks * border)) {
    const auto cut = [&](int k) { return static_cast<int>(static_cast<long>(blocks) * k / chunks); };
    for (int chunk = 0; chunk < chunks; ++chunk) {
        ranges_.push_back({cut(chunk), cut(chunk + 1)});
        inner_.push_back(std::make_unique<BlockChain>(ranges_.back().size() - 1, size, border));
    }
    std::iota(all_border_.begin(), all_border_.end(), 0);
}

std::span<const int> CyclicBorder::active(int chunk) const noexcept {
    const auto c = static_cast<std::size_t>(chunk);
    return {active_.data() + c * static_cast<std::size_t>(border_), static_cast<std::size_t>(active_count_[c])};
}

void CyclicBorder::clear(int chunk, std::span<const int> border) noexcept {
    std::copy(border.begin(), border.end(), active_.begin() + chunk * border_);
    active_count_[static_cast<std::size_t>(chunk)] = static_cast<int>(border.size());
    inner(chunk).clear(static_cast<int>(border.size()));
    std::fill_n(separator(chunk), size_ * (size_ + 2 * border_), 0.0);
}

CyclicBorder::Block CyclicBorder::block(int number) noexcept {
    const auto after = std::upper_bound(ranges_.begin(), ranges_.end(), number, [](int n, const Range& range) { return n < range.last; });
    const int chunk = static_cast<int>(after - ranges_.begin());
    if (number + 1 < range(chunk).last) {
        const BlockChain::Rows rows = inner(chunk).block(number - range(chunk).first);
        return {rows.lower, rows.diagonal, rows.upper, rows.columns, rows.rows, rows.stride, rows.stride, active(chunk)};
    }
    double* given = separator(chunk);
    double* columns = given + size_ * size_;
    return {inner(chunk).right_lower(),
            given,
            inner(chunk + 1 == chunks() ? 0 : chunk + 1).left_upper(),
            columns,
            columns + size_ * border_,
            size_,
            border_,
            all_border_};
}

bool CyclicBorder::eliminate(int chunk) noexcept { return inner(chunk).eliminate(); }

/// Block at a row and a column of the reduced system; number chunks() is the border.
CyclicBorder::Place CyclicBorder::place(int row, int column) noexcept {
    const int last = chunks() - 1;
    const int edge = size_ + border_;
    if (row == last && column < last)  // on one of the separator's neighbours
        return {column + 1 == last ? ring_.right_lower() : ring_.left_upper(), size_};
    if (row >= last && column >= last) return {matrix_.data() + (row > last ? size_ * edge : 0) + (column > last ? size_ : 0), edge};
    if (row > last) return {ring_.block(column).rows, size_};
    const BlockChain::Rows rows = ring_.block(row);
    if (column > last) return {rows.columns, rows.stride};
    if (column == row) return {rows.diagonal, size_};
    if (column == row + 1) return {rows.upper, rows.stride};
    return {rows.lower, size_};
}

void CyclicBorder::collect_given(int chunk) noexcept {
    const double* given = separator(chunk);
    const auto put = [&](int row, int column, int rows, int columns, const double* part) {
        const Place to = place(row, column);
        add(rows, columns, part, columns, to.at, to.stride);
    };
    put(chunk, chunk, size_, size_, given);
    put(chunk, chunks(), size_, border_, given + size_ * size_);
    put(chunks(), chunk, border_, size_, given + size_ * (size_ + border_));
}

void CyclicBorder::collect_inner(int chunk) noexcept {
    const BlockChain& from = inner(chunk);
    const std::span<const int> seen = active(chunk);
    const int sees = from.active(), stride = from.stride(), border = chunks();
    const auto put = [&](int row, const double* part) {  // [on right | on left | on active]
        const bool outside = row == border;
        const int rows = outside ? sees : size_;
        const std::span<const int> row_of = outside ? seen : std::span<const int>{};
        const Place right = place(row, chunk);
        add(rows, size_, part, stride, right.at, right.stride, row_of);
        const Place left = place(row, previous(chunk));
        add(rows, size_, part + size_, stride, left.at, left.stride, row_of);
        const Place all = place(row, border);
        add(rows, sees, part + 2 * size_, stride, all.at, all.stride, row_of, seen);
    };
    put(chunk, from.right_row());
    put(previous(chunk), from.outer_rows());
    put(border, from.outer_rows() + size_ * stride);
}

void CyclicBorder::collect_ring() noexcept {
    const int edge = size_ + border_, stride = ring_.stride();
    const auto put = [&](int rows, const double* part, double* into) {
        add(rows, size_, part, stride, into, edge);
        add(rows, size_, part + size_, stride, into, edge);
        add(rows, border_, part + 2 * size_, stride, into + size_, edge);
    };
    put(size_, ring_.right_row(), matrix_.data());
    put(size_ + border_, ring_.outer_rows(), matrix_.data());
}

bool CyclicBorder::join() noexcept {
    ring_.clear(border_);
    std::fill(matrix_.begin(), matrix_.end(), 0.0);
    const int edge = size_ + border_;
    add(border_, border_, corner_.data(), border_, matrix_.data() + size_ * edge + size_, edge);
    for (int chunk = 0; chunk < chunks(); ++chunk) {
        collect_given(chunk);
        collect_inner(chunk);
    }
    if (!ring_.eliminate()) return false;
    collect_ring();
    return factorise(edge, matrix_.data(), exchanges_.data());
}

void CyclicBorder::forward(int chunk, const double* f) noexcept { inner(chunk).forward(f + range(chunk).first * size_); }

void CyclicBorder::join_solution(const double* f) noexcept {
    double* border = known(chunks());
    std::copy_n(f + blocks_ * size_, border_, border);
    for (int chunk = 0; chunk < chunks(); ++chunk) std::copy_n(f + (range(chunk).last - 1) * size_, size_, known(chunk));
    for (int chunk = 0; chunk < chunks(); ++chunk) {
        const BlockChain& from = inner(chunk);
        add(size_, 1, from.right_part(), 1, known(chunk), 1);
        add(size_, 1, from.outer_part(), 1, known(previous(chunk)), 1);
        add(from.active(), 1, from.outer_part() + size_, 1, border, 1, active(chunk));
    }
    double* last = known(chunks() - 1);
    ring_.forward(known_.data());
    add(size_, 1, ring_.right_part(), 1, last, 1);
    add(size_ + border_, 1, ring_.outer_part(), 1, last, 1);
    solve_factorised(size_ + border_, matrix_.data(), exchanges_.data(), last, 1, 1);
    ring_.backward(last, last, border, known_.data());
    for (int chunk = 0; chunk < chunks(); ++chunk) {
        const std::span<const int> seen = active(chunk);
        for (std::size_t k = 0; k < seen.size(); ++k) seen_[static_cast<std::size_t>(chunk * border_) + k] = border[seen[k]];
    }
}

void CyclicBorder::backward(int chunk, double* x) noexcept {
    const Range& bounds = range(chunk);
    inner(chunk).backward(known(previous(chunk)), known(chunk), seen_.data() + chunk * border_, x + bounds.first * size_);
    std::copy_n(known(chunk), size_, x + (bounds.last - 1) * size_);
    if (chunk == 0) std::copy_n(known(chunks()), border_, x + blocks_ * size_);
}

}  // namespace cvtflow::bench
