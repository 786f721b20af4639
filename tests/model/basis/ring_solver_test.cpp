/// Rings of equations of many lengths: the solution satisfies each equation, also where lanes have parts of different lengths.

#include <gtest/gtest.h>
#include <cmath>
#include <random>
#include <vector>

#include "model/basis/ring_solver.hpp"

namespace cvtflow::model {
namespace {

TEST(RingSolver, SatisfiesEachEquationOfRingsOfAnyLength) {
    std::mt19937 random(1);
    const auto between = [&](double low, double high) { return low + (high - low) * static_cast<double>(random() % 1000) / 999.0; };
    for (int count = 3; count < 70; ++count) {
        std::vector<double> rhs, own, back, on;
        for (int k = 0; k < count; ++k) {
            const double coupling = k % 5 == 0 ? 0.0 : between(0.0, 1.0) * (k % 7 == 0 ? 1e6 : 1.0);  // a chain between open places; stiff
            rhs.push_back(between(-100.0, 100.0));
            own.push_back(1.0 + 4.0 * coupling);
            back.push_back(coupling * between(0.0, 1.0));
            on.push_back(coupling * between(0.0, 1.0));
        }
        const RingShares shares(count);
        const auto repeated = [&](const std::vector<double>& of_ring) {  // one number in front, as many behind as squares of vectors read
            std::vector<double> all;
            for (int k = -1; k < shares.equations + 2 * RingShares::lanes; ++k)
                all.push_back(of_ring[static_cast<std::size_t>((k + count) % count)]);
            return all;
        };
        std::vector<double> memory[7];
        for (auto& row : memory) row.assign(static_cast<std::size_t>(shares.rows * RingShares::lanes), 0.0);
        const std::vector<double>* const coefficients[] = {&rhs, &own, &back, &on};
        for (std::size_t k = 0; k < 4; ++k) shares.to_rows(repeated(*coefficients[k]).data() + 1, memory[k].data());
        const auto row = [&](int k) { return memory[k].data(); };
        solve_ring(shares, {row(0), row(1), row(2), row(3), row(4), row(5), row(6)});
        std::vector<double> x(static_cast<std::size_t>(shares.equations + RingShares::lanes));  // squares of vectors are written
        shares.from_rows(row(6), x.data() + 1);
        x.erase(x.begin());
        x.resize(static_cast<std::size_t>(shares.equations));
        for (std::size_t k = rhs.size(); k < x.size(); ++k) EXPECT_NEAR(x[k], x[k - rhs.size()], 1e-12 * (1.0 + std::abs(x[k])));
        x.resize(rhs.size());
        for (std::size_t k = 0, n = x.size(); k < n; ++k) {
            const double found = (own[k] - back[k] - on[k]) * x[k] - back[k] * x[(k + n - 1) % n] - on[k] * x[(k + 1) % n];
            EXPECT_NEAR(found, rhs[k], 1e-9 * own[k]) << k << " of " << count;
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
