#include "engine/method/compiled_plan.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace cvtflow::engine {
namespace {

constexpr int size = 173;

/// Random slots; state and slope vectors of `size` numbers of very different magnitude.
class Combine : public testing::TestWithParam<std::pair<int, int>> {
protected:
    Combine() {
        std::mt19937_64 random(20240611);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        const auto [state_terms, slope_terms] = GetParam();
        for (int slot = 0; slot < 9; ++slot) {
            slots_.emplace_back(size);
            for (double& x : slots_.back()) x = uniform(random) * std::exp2(20.0 * uniform(random));
            pointers_.push_back(slots_.back().data());
        }
        for (int i = 0; i < state_terms; ++i) states_.push_back({(5 * i + 2) % 9, uniform(random)});
        for (int i = 0; i < slope_terms; ++i) slopes_.push_back({(4 * i + 1) % 9, uniform(random)});
    }

    [[nodiscard]] PlanStep step() const { return {states_, slopes_, -1, 0, 0.0}; }
    [[nodiscard]] SlotView view() const { return {pointers_.data(), pointers_.data()}; }

    /// The definition, element by element.
    [[nodiscard]] double expected(int i, double h) const {
        double sum = 0.0;
        bool first = true;
        const auto add = [&](double x) { sum = std::exchange(first, false) ? x : sum + x; };
        for (const Term& term : states_) add(term.factor * slots_[static_cast<std::size_t>(term.slot)][static_cast<std::size_t>(i)]);
        for (const Term& term : slopes_) add((h * term.factor) * slots_[static_cast<std::size_t>(term.slot)][static_cast<std::size_t>(i)]);
        return sum;
    }

    std::vector<std::vector<double>> slots_;
    std::vector<const double*> pointers_;
    std::vector<Term> states_;
    std::vector<Term> slopes_;
};

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

TEST_P(Combine, IsTheSumFromLeftToRight) {
    std::vector<double> out(size, -1.0);
    combine(step(), 0.37, view(), 0, size, out.data());
    for (int i = 0; i < size; ++i) EXPECT_EQ(bits(out[static_cast<std::size_t>(i)]), bits(expected(i, 0.37))) << i;
}

TEST_P(Combine, IsBitwiseEqualUnderAnySplitOfTheRange) {
    std::vector<double> whole(size);
    combine(step(), 0.37, view(), 0, size, whole.data());
    for (int cut = 0; cut <= size; ++cut) {
        std::vector<double> parts(size);
        combine(step(), 0.37, view(), 0, cut, parts.data());
        combine(step(), 0.37, view(), cut, size, parts.data() + cut);
        for (std::size_t i = 0; i < parts.size(); ++i) ASSERT_EQ(bits(parts[i]), bits(whole[i])) << "cut " << cut << ", element " << i;
    }
}

TEST_P(Combine, WritesNothingOutsideItsRange) {
    std::vector<double> out(size, 42.0);
    combine(step(), 1.0, view(), 20, 30, out.data() + 20);
    for (int i = 0; i < size; ++i) {
        const bool inside = i >= 20 && i < 30;
        EXPECT_EQ(out[static_cast<std::size_t>(i)], inside ? expected(i, 1.0) : 42.0) << i;
    }
}

INSTANTIATE_TEST_SUITE_P(Terms, Combine,
                         testing::Values(std::pair{0, 0}, std::pair{1, 0}, std::pair{1, 1}, std::pair{1, 2}, std::pair{2, 1},
                                         std::pair{2, 2}, std::pair{1, 4}, std::pair{3, 3}, std::pair{2, 7}, std::pair{0, 5}),
                         [](const auto& info) {
                             return std::to_string(info.param.first) + "_states_and_" + std::to_string(info.param.second) + "_slopes";
                         });

}  // namespace
}  // namespace cvtflow::engine
