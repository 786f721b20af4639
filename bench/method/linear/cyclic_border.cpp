#include "bench/method/linear/cyclic_border.hpp"

#include <algorithm>
#include <numeric>

#include "bench/method/linear/dense.hpp"

namespace cvtflow::bench {

namespace {

/// into[row_of[i], column_of[j]] += part[i, j]; an empty map is the identity.
void add(int rows, int columns, const double* part, int stride, double* into, int into_stride, std::span<const int> row_of = {},
         std::span<const int> column_of = {}) noexcept {
    for (int i = 0; i < rows; ++i) {
        double* row = into + into_stride * (row_of.empty() ? i : row_of[static_cast<std::size_t>(i)]);
        for (int j = 0; j < columns; ++j) row[column_of.empty() ? j : column_of[static_cast<std::size_t>(j)]] += part[i * stride + j];
    }
}

[[nodiscard]] std::vector<double> zero_vector(int count) { return std::vector<double>(static_cast<std::size_t>(count), 0.0); }

}  // namespace

CyclicBorder::CyclicBorder(int blocks, int size, int border, int chunks)
    : blocks_(blocks),
      size_(size),
      border_(border),
      active_(static_cast<std::size_t>(chunks * border)),
      active_count_(static_cast<std::size_t>(chunks)),
      all_border_(static_cast<std::size_t>(border)),
      separators_(zero_vector(chunks * size * (size + 2 * border))),
      ring_(chunks - 1, size, border),
      corner_(zero_vector(border * border)),
      matrix_(zero_vector((size + border) * (size + border))),
      exchanges_(static_cast<std::size_t>(size + border)),
      known_(zero_vector(chunks * size + border)),
      seen_(zero_vector(chunks * border)) {
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

/// Where row and column of the reduced system meet; number chunks() is the border.
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
    const Range& own = range(chunk);
    inner(chunk).backward(known(previous(chunk)), known(chunk), seen_.data() + chunk * border_, x + own.first * size_);
    std::copy_n(known(chunk), size_, x + (own.last - 1) * size_);
    if (chunk == 0) std::copy_n(known(chunks()), border_, x + blocks_ * size_);
}

}  // namespace cvtflow::bench
