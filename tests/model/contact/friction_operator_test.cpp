/// Which tips touch, as a record of contacts finds them. (Friction by its kernels: tests/model/kernels/kernels_test.cpp)

#include <gtest/gtest.h>

#include <algorithm>

#include "model/contact/friction_operator.hpp"
#include "model/law/phase_rule.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

/// Phases that a record finds in ranges of a length, beginning with all tips in a phase.
std::vector<Phase> found_phases(const Variator& variator, const oracle::RandomState& random, Phase begin, TipSearch& search, int length) {
    const ChainLayout& at = variator.layout();
    EvaluationScratch scratch(at);
    fill_window(variator, random.state.data(), scratch);
    variator.pulleys().motions(random.state.data() + at.pulley_begin(), scratch.sheaves);
    const FrictionOperator friction = make_friction(variator.chain(), false);
    ContactField field(variator.chain());
    FloatColumns frictionless(at.link_size(), at.links + 2), velocity(at.link_size(), at.links + 2);
    std::vector<Phase> phases(random.phases.size(), begin);
    search.phases = phases.data();
    for (int first = 0; first < at.links; first += length) {
        const ChainRange range{first, std::min(first + length, at.links), scratch.window.data() + first * at.link_block(), scratch.sheaves,
                               phases.data()};
        friction.record(range, {}, {random.state.data() + at.link_begin(first), field, frictionless, velocity},
                        scratch.loads.data() + first, &search);
    }
    return phases;
}

TEST(FrictionOperator, ARecordFindsTheTipsThatTouchByTheRule) {
    const PhaseRule rule;
    for (const auto pulleys : {PulleyDetail::rigid, PulleyDetail::elastic}) {
        Parameters p = oracle::small_scene();
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
                EXPECT_EQ(found_phases(variator, random, begin, in_limits, length), due) << length;
                EXPECT_FALSE(in_limits.suspect);
                (void)found_phases(variator, random, begin, beyond, length);
                EXPECT_TRUE(beyond.suspect);
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
