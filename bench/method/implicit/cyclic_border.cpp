#include "bench/method/implicit/cyclic_border.hpp"

#include <algorithm>

namespace cvtflow::bench {

namespace {

[[nodiscard]] bool factorise(Eigen::PartialPivLU<Eigen::MatrixXd>& lu, const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
    lu.compute(matrix);
    const auto pivots = lu.matrixLU().diagonal().array();
    return pivots.isFinite().all() && (pivots != 0.0).all();
}

}  // namespace

BlockChain::BlockChain(int size_, int blocks_, int eliminated_, int most)
    : size(size_),
      blocks(blocks_),
      eliminated(eliminated_),
      scratch(size, std::max(size, most)),
      pivots(static_cast<std::size_t>(eliminated)) {
    matrix.setZero(blocks * size + most, blocks * size + most);
    x.setZero(matrix.rows());
    for (auto& pivot : pivots) pivot = Eigen::PartialPivLU<Eigen::MatrixXd>(size);
}

void BlockChain::clear(int outer_now) {
    outer = outer_now;
    matrix.topLeftCorner(blocks * size + outer, blocks * size + outer).setZero();
}

bool BlockChain::eliminate() {
    const int edge = blocks * size;
    for (int k = 0; k < eliminated; ++k) {
        const int here = k * size, next = here + size;
        auto& pivot = pivots[static_cast<std::size_t>(k)];
        if (!factorise(pivot, matrix.block(here, here, size, size))) return false;
        const std::pair<int, int> others[] = {{next, std::min(size, edge - next)}, {edge, outer}};  // first, number
        for (const auto& [column, columns] : others) {
            auto solved = scratch.leftCols(columns);
            solved = pivot.solve(matrix.block(here, column, size, columns));
            matrix.block(here, column, size, columns) = solved;
            for (const auto& [row, rows] : others)
                matrix.block(row, column, rows, columns).noalias() -= matrix.block(row, here, rows, size) * solved;
        }
    }
    return true;
}

void BlockChain::forward() {
    for (int k = 0; k < eliminated; ++k) {
        const int here = k * size, next = here + size, near = std::min(size, blocks * size - next);
        auto solved = scratch.col(0);
        solved = pivots[static_cast<std::size_t>(k)].solve(x.segment(here, size));
        x.segment(here, size) = solved;
        x.segment(next, near).noalias() -= matrix.block(next, here, near, size) * solved;
        x.segment(blocks * size, outer).noalias() -= matrix.block(blocks * size, here, outer, size) * solved;
    }
}

void BlockChain::backward() {
    for (int k = eliminated; k-- > 0;) {
        const int here = k * size, next = here + size, near = std::min(size, blocks * size - next);
        x.segment(here, size).noalias() -= matrix.block(here, next, size, near) * x.segment(next, near);
        x.segment(here, size).noalias() -= matrix.block(here, blocks * size, size, outer) * x.segment(blocks * size, outer);
    }
}

CyclicBorder::CyclicBorder(int blocks, int size, int border, int chunks)
    : blocks_(blocks),
      size_(size),
      border_(border),
      chunks_(chunks),
      kept_(static_cast<std::size_t>(chunks)),
      ring_(size, chunks - 1, chunks - 1, size + border),
      corner_(Eigen::MatrixXd::Zero(border, border)),
      last_(size + border) {
    for (int chunk = 0; chunk < chunks; ++chunk) {
        chains_.emplace_back(size, blocks_of(chunk), blocks_of(chunk) - 1, size + border);
        kept_[static_cast<std::size_t>(chunk)].reserve(static_cast<std::size_t>(2 * size + border));
    }
}

/// Kept unknowns of a chunk: its separator, the separator before it, border unknowns.
void CyclicBorder::clear(int chunk, std::span<const int> border) {
    std::vector<int>& kept = kept_[static_cast<std::size_t>(chunk)];
    kept.clear();
    for (const int separator : {chunk, chunk == 0 ? chunks() - 1 : chunk - 1}) {
        for (int k = 0; k < size_; ++k) kept.push_back(separator * size_ + k);
    }
    for (const int unknown : border) kept.push_back(chunks() * size_ + unknown);
    chain(chunk).clear(size_ + static_cast<int>(border.size()));
}

int CyclicBorder::chunk_of(int block) const noexcept {
    int chunk = 0;
    while (first(chunk + 1) <= block) ++chunk;
    return chunk;
}

/// Row and column of a block of the chunk, or of the separator before its first one.
int CyclicBorder::place(int chunk, int block) const noexcept {
    return size_ * (block < first(chunk) ? blocks_of(chunk) : block - first(chunk));
}

CyclicBorder::Part CyclicBorder::part(int chunk, int row, int column) noexcept {
    return chain(chunk).matrix.block(place(chunk, row), place(chunk, column), size_, size_);
}

CyclicBorder::Part CyclicBorder::lower(int block) noexcept { return part(chunk_of(block), block, block - 1); }

CyclicBorder::Part CyclicBorder::diagonal(int block) noexcept { return part(chunk_of(block), block, block); }

CyclicBorder::Part CyclicBorder::upper(int block) noexcept {
    const int next = (block + 1) % blocks_, chunk = chunk_of(next);
    return next == first(chunk) ? part(chunk, next - 1, next) : part(chunk, block, next);
}

CyclicBorder::Part CyclicBorder::columns(int block) noexcept {
    const int chunk = chunk_of(block), edge = size_ * (blocks_of(chunk) + 1);
    return chain(chunk).matrix.block(place(chunk, block), edge, size_, chain(chunk).outer - size_);
}

CyclicBorder::Part CyclicBorder::rows(int block) noexcept {
    const int chunk = chunk_of(block), edge = size_ * (blocks_of(chunk) + 1);
    return chain(chunk).matrix.block(edge, place(chunk, block), chain(chunk).outer - size_, size_);
}

bool CyclicBorder::join() {
    ring_.clear(size_ + border_);
    ring_.matrix.bottomRightCorner(border_, border_) = corner_;
    for (int chunk = 0; chunk < chunks(); ++chunk) {
        const BlockChain& from = chain(chunk);
        const std::vector<int>& to = kept_[static_cast<std::size_t>(chunk)];
        for (int column = 0; column < static_cast<int>(to.size()); ++column) {
            for (int row = 0; row < static_cast<int>(to.size()); ++row)
                ring_.matrix(to[static_cast<std::size_t>(row)], to[static_cast<std::size_t>(column)]) +=
                    from.matrix(from.kept() + row, from.kept() + column);
        }
    }
    return ring_.eliminate() && factorise(last_, ring_.matrix.bottomRightCorner(size_ + border_, size_ + border_));
}

void CyclicBorder::forward(int chunk, const double* f) {
    BlockChain& here = chain(chunk);
    here.x.head(here.kept()) = Eigen::Map<const Eigen::VectorXd>(f + first(chunk) * size_, here.kept());
    here.x.tail(here.x.size() - here.kept()).setZero();
    here.forward();
}

void CyclicBorder::join_solution(const double* f) {
    ring_.x.tail(border_) = Eigen::Map<const Eigen::VectorXd>(f + blocks_ * size_, border_);
    for (int chunk = 0; chunk < chunks(); ++chunk)
        ring_.x.segment(chunk * size_, size_) = Eigen::Map<const Eigen::VectorXd>(f + (first(chunk + 1) - 1) * size_, size_);
    for (int chunk = 0; chunk < chunks(); ++chunk) {
        const double* from = chain(chunk).x.data() + chain(chunk).kept();
        for (const int unknown : kept_[static_cast<std::size_t>(chunk)]) ring_.x[unknown] += *from++;
    }
    ring_.forward();
    Eigen::Map<Eigen::VectorXd> solved(ring_.scratch.data(), size_ + border_);
    solved = last_.solve(ring_.x.tail(size_ + border_));
    ring_.x.tail(size_ + border_) = solved;
    ring_.backward();
}

void CyclicBorder::backward(int chunk, double* x) {
    BlockChain& here = chain(chunk);
    double* to = here.x.data() + here.kept();
    for (const int unknown : kept_[static_cast<std::size_t>(chunk)]) *to++ = ring_.x[unknown];
    here.backward();
    Eigen::Map<Eigen::VectorXd>(x + first(chunk) * size_, blocks_of(chunk) * size_) = here.x.head(blocks_of(chunk) * size_);
    if (chunk == 0) Eigen::Map<Eigen::VectorXd>(x + blocks_ * size_, border_) = ring_.x.tail(border_);
}

}  // namespace cvtflow::bench
