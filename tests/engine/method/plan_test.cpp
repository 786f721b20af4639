/// Plans of methods: the catalogue, compiled ones, and the combinations that their stages form.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "engine/method/catalogue.hpp"
#include "engine/method/compiled_plan.hpp"
#include "plan_fixture.hpp"

namespace cvtflow::engine {
namespace {

TEST(MethodCatalogue, EveryMethodIsDescribed) {
    for (const StagePlan& plan : methods()) {
        EXPECT_FALSE(plan.description.empty()) << plan.name;
        EXPECT_FALSE(plan.source.empty()) << plan.name;
    }
}

TEST(MethodCatalogue, NamesAreUniqueAndFound) {
    std::set<std::string> names;
    for (const StagePlan& plan : methods()) {
        EXPECT_TRUE(names.insert(plan.name).second) << plan.name;
        const StagePlan* found = find_method(plan.name);
        ASSERT_NE(found, nullptr) << plan.name;
        EXPECT_EQ(found->name, plan.name);
    }
}

TEST(MethodCatalogue, UnknownNamesGiveNothing) {
    EXPECT_EQ(find_method("rk5"), nullptr);
    EXPECT_EQ(find_method(""), nullptr);
}

bool same(std::span<const Term> a, const std::vector<Term>& b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

TEST(CompiledPlan, CarriesEveryTermOfThePlan) {
    const StagePlan plan = test::dumka3_degree_3();
    const CompiledPlan compiled(plan);
    ASSERT_EQ(compiled.stages(), 4);
    for (int i = 0; i < compiled.stages(); ++i) {
        const Stage& stage = plan.stages[static_cast<std::size_t>(i)];
        const PlanStep step = compiled.stage(i);
        EXPECT_TRUE(same(step.states, stage.states) && same(step.slopes, stage.slopes)) << i;
        EXPECT_EQ(step.keep, stage.keep);
        EXPECT_EQ(step.slope, stage.slope);
    }
    EXPECT_TRUE(same(compiled.result().states, plan.result.states));
    ASSERT_TRUE(compiled.has_error());
    EXPECT_TRUE(same(compiled.error().slopes, plan.error->slopes));
}

TEST(CompiledPlan, TheResultBelongsToTheEndOfTheStep) {
    EXPECT_NEAR(CompiledPlan(test::dumka3_degree_3()).result().time, 1.0, 1e-14);
    EXPECT_NEAR(CompiledPlan(test::dumka3_degree_6()).result().time, 1.0, 1e-14);
}

TEST(CompiledPlan, CopiesReferToTheirOwnTerms) {
    auto original = std::make_unique<CompiledPlan>(test::dumka3_degree_6());
    const CompiledPlan copy = *original;
    original.reset();
    EXPECT_TRUE(same(copy.stage(5).states, test::dumka3_degree_6().stages[5].states));
}

/// A chain of Euler substeps over two state slots, the form of the largest stabilised schemes.
TEST(CompiledPlan, CarriesLongLowStorageSchemes) {
    constexpr int substeps = 324;
    StagePlan plan{"chain", "", "", 3, 3, {{{{0, 1.0}}, {}, -1, 0}}, {}, {}};
    int state = 0;
    int slope = 0;
    for (int i = 1; i < substeps; ++i) {
        const int next = state == 1 ? 2 : 1;
        plan.stages.push_back({{{state, 1.0}}, {{slope, 1.0 / substeps}}, next, next});
        state = slope = next;
    }
    plan.result = {{{state, 1.0}}, {{slope, 1.0 / substeps}}};
    const CompiledPlan compiled(plan);
    for (int i = 0; i < substeps; ++i) EXPECT_NEAR(compiled.stage(i).time, static_cast<double>(i) / substeps, 1e-13);
}

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
