#include "model/kernels/available_isas.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/kernels/kernels.hpp"
#include "model/observe/observation.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/random_state.hpp"

namespace cvtflow::model {
namespace {

/// Everything that the kernels compute on one state, as plain numbers.
std::vector<double> outcome(const Parameters& p, Isa isa, const oracle::RandomState& random) {
    const Variator variator(p, isa);
    const ChainLayout& at = variator.layout();
    EvaluationScratch scratch(at);
    std::vector<double> all(random.state.size());
    right_hand_side(variator, 0.0, random.state.data(), random.phases.data(), all.data(), scratch);
    std::vector<LinkContact> contacts(static_cast<std::size_t>(at.links));
    const ChainRange range{0, at.links, scratch.window.data(), scratch.sheaves, random.phases.data()};
    variator.chain().observed_slopes(range, all.data(), scratch.loads.data(), scratch.accounts.data(), contacts.data());
    for (const LinkContact& contact : contacts) {
        all.push_back(contact.tension);
        for (const auto& tips : {contact.depth, contact.normal, contact.axial}) all.insert(all.end(), tips, tips + tips_per_link);
    }
    for (int link = 0; link < at.links && at.pulley_size != 0; ++link) {
        NeighbourWindow strip;
        const double* state = strip.of(at, random.state.data(), link);
        TipProbe probe;
        variator.chain().probe(state, scratch.sheaves, true, probe);
        all.insert(all.end(), probe.depth, probe.depth + tips_per_link);
        all.insert(all.end(), probe.slip, probe.slip + tips_per_link);
    }
    return all;
}

void expect_same_bits(const Parameters& p, const std::string& name, std::uint64_t seed) {
    const auto random = oracle::random_state(p, seed);
    const std::vector<double> baseline = outcome(p, Isa::baseline, random);
    for (const Isa isa : usable_isas()) {
        const std::vector<double> other = outcome(p, isa, random);
        ASSERT_EQ(other.size(), baseline.size());
        EXPECT_EQ(std::memcmp(other.data(), baseline.data(), baseline.size() * sizeof(double)), 0) << name_of(isa) << ", " << name;
    }
}

/// Every detail of both chains, accounts and laws of friction.
TEST(Isa, EveryInstructionSetGivesTheSameBits) {
    std::vector<oracle::Case> cases = oracle::all_details(oracle::small_scene());
    for (const oracle::Case& one : oracle::rigid_details(oracle::small_scene())) cases.push_back(one);
    for (const bool ledger : {false, true}) {
        for (const FrictionLaw law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
            Parameters p = oracle::small_scene();
            p.ledger = ledger;
            p.detail.friction = law;
            p.detail.stick_slip = law == FrictionLaw::piecewise;
            p.plate.count = 37;  // three chunks of plates
            p.detail.joint_points = 16;
            cases.push_back({"ledger " + std::to_string(ledger), p});
        }
    }
    cases.push_back({"a table of friction", oracle::small_scene()});
    model::Tip& tip = cases.back().parameters.tip;
    tip.friction_law = TipFriction::table;
    tip.friction_table = {{0.0, 0.01, 0.1, 0.5}, {0.06, 0.09, 0.08, 0.02}};
    tip.pressure_sensitivity = 0.2;
    std::uint64_t seed = 300;
    for (const oracle::Case& one : cases) expect_same_bits(one.parameters, one.name, ++seed);
}

TEST(Isa, UsableOnesAscendFromTheBaseline) {
    const std::vector<Isa> usable = usable_isas();
    ASSERT_FALSE(usable.empty());
    EXPECT_EQ(usable.front(), Isa::baseline);
    EXPECT_TRUE(std::is_sorted(usable.begin(), usable.end()));
    for (const Isa isa : usable) EXPECT_EQ(isa_named(name_of(isa)), isa);
}

TEST(Isa, IsChosenByTheEnvironmentOrTheProcessor) {
    const char* before = std::getenv("CVTFLOW_ISA");
    const std::string kept = before == nullptr ? "" : before;
    setenv("CVTFLOW_ISA", "baseline", 1);
    EXPECT_EQ(chosen_isa(), Isa::baseline);
    EXPECT_EQ(Variator(oracle::small_scene()).chain().isa(), Isa::baseline);
    setenv("CVTFLOW_ISA", "auto", 1);
    EXPECT_EQ(chosen_isa(), usable_isas().back());
    setenv("CVTFLOW_ISA", kept.c_str(), 1);
}

TEST(Isa, SaysWhatThereIsWhenOneIsUnknown) {
    std::string all, have;
    for (const CompiledKernels& kernels : compiled_kernels()) all += (all.empty() ? "" : ", ") + std::string(name_of(kernels.isa));
    for (const Isa isa : usable_isas()) have += (have.empty() ? "" : ", ") + std::string(name_of(isa));
    try {
        (void)isa_named("sse9");
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_EQ(std::string(error.what()),
                  "instruction set \"sse9\" is unknown (this build has " + all + "; this processor runs " + have + " of them)");
    }
}

}  // namespace
}  // namespace cvtflow::model
