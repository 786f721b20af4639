/// Plans of methods: the catalogue, and the combinations that their stages form.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/method/catalogue.hpp"
#include "engine/method/compiled_plan.hpp"

namespace cvtflow::engine {
namespace {

TEST(MethodCatalogue, EveryMethodIsDescribedAndFoundByItsName) {
    std::set<std::string> names;
    for (const StagePlan& plan : methods()) {
        EXPECT_FALSE(plan.description.empty()) << plan.name;
        EXPECT_FALSE(plan.source.empty()) << plan.name;
        EXPECT_TRUE(names.insert(plan.name).second) << plan.name;
        ASSERT_NE(find_method(plan.name), nullptr) << plan.name;
        EXPECT_EQ(find_method(plan.name)->name, plan.name);
    }
    for (const char* unknown : {"rk5", ""}) EXPECT_EQ(find_method(unknown), nullptr);
}

constexpr int size = 173;

/// Combination of random slots: state and slope vectors of `size` numbers of very different magnitude.
struct RandomCombination {
    RandomCombination(int state_terms, int slope_terms) {
        std::mt19937_64 random(20240611);
        std::uniform_real_distribution<double> uniform(-1.0, 1.0);
        for (int slot = 0; slot < 9; ++slot) {
            slots.emplace_back(size);
            for (double& x : slots.back()) x = uniform(random) * std::exp2(20.0 * uniform(random));
            pointers.push_back(slots.back().data());
        }
        for (int i = 0; i < state_terms; ++i) states.push_back({(5 * i + 2) % 9, uniform(random)});
        for (int i = 0; i < slope_terms; ++i) slopes.push_back({(4 * i + 1) % 9, uniform(random)});
    }
    void write(int begin, int end, std::vector<double>& out) const {
        combine({states, slopes, -1, 0, 0.0}, 0.37, {pointers.data(), pointers.data()}, begin, end, out.data() + begin);
    }
    /// The definition, element by element.
    [[nodiscard]] double expected(std::size_t i) const {
        double sum = 0.0;
        bool first = true;
        const auto add = [&](double x) { sum = std::exchange(first, false) ? x : sum + x; };
        for (const Term& term : states) add(term.factor * slots[static_cast<std::size_t>(term.slot)][i]);
        for (const Term& term : slopes) add((0.37 * term.factor) * slots[static_cast<std::size_t>(term.slot)][i]);
        return sum;
    }

    std::vector<std::vector<double>> slots;
    std::vector<const double*> pointers;
    std::vector<Term> states, slopes;
};

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

TEST(Combine, IsTheSumFromLeftToRightUnderAnySplitAndWritesNothingOutsideItsRange) {
    for (const auto& [states, slopes] : {std::pair{0, 0}, {1, 0}, {1, 1}, {1, 2}, {2, 1}, {2, 2}, {1, 4}, {3, 3}, {2, 7}, {0, 5}}) {
        SCOPED_TRACE(std::to_string(states) + " states and " + std::to_string(slopes) + " slopes");
        const RandomCombination combination(states, slopes);
        for (int cut = 0; cut <= size; ++cut) {
            std::vector<double> parts(size);
            combination.write(0, cut, parts);
            combination.write(cut, size, parts);
            for (std::size_t i = 0; i < parts.size(); ++i) ASSERT_EQ(bits(parts[i]), bits(combination.expected(i))) << cut << ", " << i;
        }
        std::vector<double> out(size, 42.0);
        combination.write(20, 30, out);
        for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out[i], i >= 20 && i < 30 ? combination.expected(i) : 42.0) << i;
    }
}

}  // namespace
}  // namespace cvtflow::engine
