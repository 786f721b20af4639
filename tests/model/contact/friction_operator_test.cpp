/// Friction as a function of velocities, against the whole right-hand side with and without friction.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/contact/friction_operator.hpp"
#include "model/law/phase_rule.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

Parameters without_friction(Parameters p) {
    p.joint.friction.coefficient = p.tip.friction.coefficient = p.plate.friction.coefficient = 0.0;
    return p;
}

std::vector<double> slope_of(const Parameters& p, const oracle::RandomState& random) {
    const Variator variator(p);
    EvaluationScratch scratch(variator.layout());
    std::vector<double> slope(random.state.size());
    right_hand_side(variator, 0.0, random.state.data(), random.phases.data(), slope.data(), scratch);
    return slope;
}

/// Acceleration of every link by friction alone, evaluated in ranges of the given length.
std::vector<double> friction_of(const Parameters& p, const oracle::RandomState& random, int length) {
    const Variator variator(p);
    const ChainLayout& at = variator.layout();
    const int size = at.link_size();
    EvaluationScratch scratch(at);
    fill_window(variator, random.state.data(), scratch);
    if (at.pulley_size != 0) variator.pulleys().motions(random.state.data() + at.pulley_begin(), scratch.sheaves);
    const FrictionOperator friction = make_friction(variator.chain(), p.detail.stick_slip);
    ContactField field(variator.chain());
    Columns frictionless(size, at.links + 2), slope(size, at.links + 2);
    friction.record({0, at.links, scratch.window.data(), scratch.sheaves, random.phases.data()}, {}, field, frictionless,
                    scratch.loads.data());
    for (int first = 0; first < at.links; first += length) {
        const int last = std::min(first + length, at.links);
        const int stride = last - first + 16;
        std::vector<double> window(static_cast<std::size_t>(size * stride), 0.0),
            memory(static_cast<std::size_t>(friction.scratch_size(last - first)));
        for (int link = first - 1; link <= last; ++link) {
            const double* v = random.state.data() + at.link_begin((link + at.links) % at.links) + size;
            for (int row = 0; row < size; ++row) window[static_cast<std::size_t>(row * stride + link - first + 1)] = v[row];
        }
        friction.slopes(field, {first, last, window.data(), stride, memory.data(), random.phases.data(), 0.0}, {nullptr, &slope});
    }
    std::vector<double> accelerations;
    for (int link = 0; link < at.links; ++link) {
        for (int row = 0; row < size; ++row) accelerations.push_back(*slope.at(row, link + 1));
    }
    return accelerations;
}

/// The two sides differ by rounding of forces that cancel: 1e-11 of the largest acceleration.
TEST(FrictionOperator, IsTheDifferenceThatFrictionMakes) {
    for (int order = 0; order <= 3; ++order) {
        for (const bool stick_slip : {false, true}) {
            Parameters p = oracle::small_scene();
            p.detail.order = order;
            p.detail.stick_slip = stick_slip;
            const auto random = oracle::random_state(p, 31);
            const auto with = slope_of(p, random), without = slope_of(without_friction(p), random),
                       alone = friction_of(p, random, p.chain.pins);
            const ChainLayout at = layout_of(p);
            double largest = 0.0;
            for (const double a : alone) largest = std::max(largest, std::abs(a));
            ASSERT_GT(largest, 0.0);
            for (int link = 0; link < at.links; ++link) {
                for (int row = 0; row < at.link_size(); ++row) {
                    const auto k = static_cast<std::size_t>(at.link_begin(link) + at.link_size() + row);
                    EXPECT_NEAR(alone[static_cast<std::size_t>(link * at.link_size() + row)], with[k] - without[k], 1e-11 * largest)
                        << "order " << order << " link " << link << " row " << row;
                }
            }
        }
    }
}

/// Phases that a record finds in ranges of a length, beginning with all tips in a phase.
std::vector<Phase> found_phases(const Variator& variator, const oracle::RandomState& random, Phase begin, TipSearch& search, int length) {
    const ChainLayout& at = variator.layout();
    EvaluationScratch scratch(at);
    fill_window(variator, random.state.data(), scratch);
    variator.pulleys().motions(random.state.data() + at.pulley_begin(), scratch.sheaves);
    const FrictionOperator friction = make_friction(variator.chain(), false);
    ContactField field(variator.chain());
    Columns frictionless(at.link_size(), at.links + 2);
    std::vector<Phase> phases(random.phases.size(), begin);
    search.phases = phases.data();
    for (int first = 0; first < at.links; first += length) {
        const ChainRange range{first, std::min(first + length, at.links), scratch.window.data() + first * at.link_block(), scratch.sheaves,
                               phases.data()};
        friction.record(range, {}, field, frictionless, scratch.loads.data() + first, &search);
    }
    return phases;
}

TEST(FrictionOperator, ARecordFindsTheTipsThatTouchByTheRule) {
    const PhaseRule rule;
    for (int order = 0; order <= 3; ++order) {
        for (const auto pulleys : {PulleyDetail::rigid, PulleyDetail::elastic}) {
            Parameters p = oracle::small_scene();
            p.detail.order = order;
            p.detail.pulleys = pulleys;
            const auto random = oracle::random_state(p, 33);
            const Variator variator(p);
            SheaveMotion sheaves[4];
            variator.pulleys().motions(random.state.data() + variator.layout().pulley_begin(), sheaves);
            for (const Phase begin : {Phase::free, Phase::touching}) {
                std::vector<Phase> due;
                double deepest = 0.0;
                for (int link = 0; link < p.chain.pins; ++link) {
                    TipProbe probe;
                    variator.chain().probe(random.state.data() + variator.layout().link_begin(link), sheaves, false, probe);
                    for (const double depth : probe.depth) {
                        due.push_back(rule.next(begin, {depth, 0.0}));
                        deepest = std::max(deepest, depth);
                    }
                }
                EXPECT_GT(std::count(due.begin(), due.end(), Phase::touching), 8) << "tips of both kinds";
                EXPECT_GT(std::count(due.begin(), due.end(), Phase::free), 8);
                for (const int length : {1, 3, p.chain.pins}) {
                    TipSearch in_limits{nullptr, rule.release, deepest, 0.0, 1.0}, beyond{nullptr, rule.release, 0.9 * deepest, 0.0, 1.0};
                    EXPECT_EQ(found_phases(variator, random, begin, in_limits, length), due) << order << ", " << length;
                    EXPECT_FALSE(in_limits.suspect);
                    (void)found_phases(variator, random, begin, beyond, length);
                    EXPECT_TRUE(beyond.suspect);
                }
            }
        }
    }
}

TEST(FrictionOperator, IsTheSameToTheLastBitForRangesOfAnyLength) {
    const Parameters p = oracle::small_scene();
    const auto random = oracle::random_state(p, 32);
    const auto whole = friction_of(p, random, p.chain.pins);
    for (const int length : {1, 2, 3, 5, 8, 11}) EXPECT_EQ(friction_of(p, random, length), whole) << length;
}

}  // namespace
}  // namespace cvtflow::model
