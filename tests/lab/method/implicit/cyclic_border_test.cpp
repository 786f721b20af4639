#include "bench/method/implicit/cyclic_border.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>
#include <vector>

namespace cvtflow::bench {
namespace {

/// A random matrix of the structure, near the identity, in both forms. Blocks of an odd number have no border.
struct BorderedSystem {
    int blocks, size, border;
    Eigen::MatrixXd dense;
    std::vector<double> rhs;

    BorderedSystem(int blocks_, int size_, int border_, unsigned seed) : blocks(blocks_), size(size_), border(border_) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> value(-0.3, 0.3);
        const int n = blocks * size + border;
        dense = Eigen::MatrixXd::Identity(n, n);
        const auto fill = [&](int row, int column, int rows, int columns) {
            for (int i = 0; i < rows; ++i) {
                for (int j = 0; j < columns; ++j) dense(row + i, column + j) += value(random);
            }
        };
        for (int i = 0; i < blocks; ++i) {
            for (const int j : {i, (i + 1) % blocks, (i + blocks - 1) % blocks}) fill(i * size, j * size, size, size);
            if (i % 2 != 0) continue;
            fill(i * size, blocks * size, size, border);
            fill(blocks * size, i * size, border, size);
        }
        fill(blocks * size, blocks * size, border, border);
        dense.diagonal().array() += 2.0;
        for (int i = 0; i < n; ++i) rhs.push_back(value(random));
    }
};

/// Fills it with border unknowns in another order; blocks of an odd number have none.
void fill(const BorderedSystem& p, CyclicBorder& system) {
    const int n = p.size, edge = p.blocks * n;
    const auto block = [&](int row, int column) { return p.dense.block(row * n, (column + p.blocks) % p.blocks * n, n, n); };
    std::vector<int> all;
    for (int k = p.border; k-- > 0;) all.push_back(k);
    for (int c = 0; c < system.chunks(); ++c) {
        bool sees = false;
        for (int i = system.first(c); i < system.first(c + 1); ++i) sees = sees || i % 2 == 0;
        system.clear(c, sees ? std::span<const int>(all) : std::span<const int>{});
    }
    for (int i = 0; i < p.blocks; ++i) {
        system.diagonal(i) = block(i, i);
        if (p.blocks > 1) system.lower(i) = block(i, i - 1);
        if (p.blocks > 2) system.upper(i) = block(i, i + 1);  // of two blocks each has one neighbour
        if (i % 2 != 0) continue;
        system.columns(i) = p.dense.block(i * n, edge, n, p.border).rowwise().reverse();
        system.rows(i) = p.dense.block(edge, i * n, p.border, n).colwise().reverse();
    }
    system.corner() = p.dense.bottomRightCorner(p.border, p.border);
}

std::vector<double> solved(const BorderedSystem& p, int chunks, bool backwards = false) {
    CyclicBorder system(p.blocks, p.size, p.border, chunks);
    fill(p, system);
    std::vector<double> x = p.rhs;
    const auto each = [&](auto&& body) {
        for (int c = 0; c < chunks; ++c) body(backwards ? chunks - 1 - c : c);
    };
    each([&](int c) { EXPECT_TRUE(system.eliminate(c)); });
    EXPECT_TRUE(system.join());
    each([&](int c) { system.forward(c, p.rhs.data()); });
    system.join_solution(p.rhs.data());
    each([&](int c) { system.backward(c, x.data()); });
    return x;
}

double residual(const BorderedSystem& p, const std::vector<double>& x) {
    const auto n = static_cast<Eigen::Index>(x.size());
    const Eigen::Map<const Eigen::VectorXd> is(x.data(), n), rhs(p.rhs.data(), n);
    const Eigen::VectorXd should = p.dense.partialPivLu().solve(rhs);
    return (is - should).lpNorm<Eigen::Infinity>() / should.lpNorm<Eigen::Infinity>();
}

TEST(CyclicBorder, SolvesAsADenseSolverDoes) {
    for (const auto& [blocks, size, border] : {std::array{84, 20, 36}, {24, 12, 37}, {12, 8, 4}, {9, 16, 0}, {7, 3, 5}}) {
        const BorderedSystem problem(blocks, size, border, 7);
        for (const int chunks : {1, 2, 3, 4, blocks / 2, blocks}) {
            if (chunks > blocks) continue;
            EXPECT_LT(residual(problem, solved(problem, chunks)), 1e-11)
                << blocks << " blocks of " << size << ", border " << border << ", chunks " << chunks;
        }
    }
}

TEST(CyclicBorder, TakesTheShortestRings) {
    for (const int blocks : {1, 2, 3}) {
        const BorderedSystem problem(blocks, 4, 3, 11);
        for (int chunks = 1; chunks <= blocks; ++chunks)
            EXPECT_LT(residual(problem, solved(problem, chunks)), 1e-12) << blocks << " in " << chunks;
    }
}

TEST(CyclicBorder, TheOrderInWhichChunksAreDoneChangesNoBit) {
    const BorderedSystem problem(30, 12, 10, 3);
    EXPECT_EQ(solved(problem, 5), solved(problem, 5, true));
}

TEST(CyclicBorder, ReportsThatAMatrixIsSingular) {
    BorderedSystem problem(6, 3, 2, 5);
    problem.dense.block(0, 0, 3, problem.dense.cols()).setZero();
    CyclicBorder system(6, 3, 2, 2);
    fill(problem, system);
    EXPECT_FALSE(system.eliminate(0));
}

}  // namespace
}  // namespace cvtflow::bench
