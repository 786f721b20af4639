#include "bench/method/linear/cyclic_border.hpp"

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

void copy(const BorderedSystem& p, int row, int column, int rows, int columns, double* to, int stride) {
    for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) to[i * stride + j] = p.dense(row + i, column + j);
    }
}

void fill_block(const BorderedSystem& p, CyclicBorder& system, int i) {
    const CyclicBorder::Block block = system.block(i);
    const int n = p.size, edge = p.blocks * n;
    copy(p, i * n, i * n, n, n, block.diagonal, n);
    if (p.blocks > 1) copy(p, i * n, (i + p.blocks - 1) % p.blocks * n, n, n, block.lower, n);
    if (p.blocks > 2)
        copy(p, i * n, (i + 1) % p.blocks * n, n, n, block.upper, block.upper_stride);  // of two blocks each has one neighbour
    for (std::size_t k = 0; k < block.border.size(); ++k) {
        const int unknown = edge + block.border[k];
        copy(p, i * n, unknown, n, 1, block.columns + k, block.columns_stride);
        copy(p, unknown, i * n, 1, n, block.rows + static_cast<int>(k) * n, n);
    }
}

std::vector<double> solved(const BorderedSystem& p, int chunks, bool backwards = false) {
    CyclicBorder system(p.blocks, p.size, p.border, chunks);
    std::vector<int> all;
    for (int k = p.border; k-- > 0;) all.push_back(k);  // in any order
    for (int c = 0; c < chunks; ++c) {
        bool sees = false;
        for (int i = system.range(c).first; i + 1 < system.range(c).last; ++i) sees = sees || i % 2 == 0;
        system.clear(c, sees ? std::span<const int>(all) : std::span<const int>{});
    }
    for (int i = 0; i < p.blocks; ++i) fill_block(p, system, i);
    copy(p, p.blocks * p.size, p.blocks * p.size, p.border, p.border, system.corner(), p.border);
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
    const std::vector<int> all{0, 1};
    for (int c = 0; c < 2; ++c) system.clear(c, all);
    for (int i = 0; i < 6; ++i) fill_block(problem, system, i);
    EXPECT_FALSE(system.eliminate(0));
}

TEST(Dense, FactorisesWithExchanges) {
    double a[9] = {0.0, 2.0, 1.0, 1.0, 1.0, 0.0, 4.0, -1.0, 3.0};
    Eigen::Matrix3d m;
    m << 0, 2, 1, 1, 1, 0, 4, -1, 3;
    int exchanges[3];
    ASSERT_TRUE(factorise(3, a, exchanges));
    double x[6] = {1, 4, 2, 5, 3, 6};
    solve_factorised(3, a, exchanges, x, 2, 2);
    Eigen::Matrix<double, 3, 2> b;
    b << 1, 4, 2, 5, 3, 6;
    const Eigen::Matrix<double, 3, 2> should = m.partialPivLu().solve(b);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 2; ++j) EXPECT_NEAR(x[2 * i + j], should(i, j), 1e-14);
    }
}

}  // namespace
}  // namespace cvtflow::bench
