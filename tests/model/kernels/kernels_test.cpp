#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/friction_operator.hpp"
#include "model/contact/friction_stage.hpp"
#include "model/kernels/available_isas.hpp"
#include "model/law/phase_rule.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/random_state.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::model {
namespace {

// Kernels of every instruction set. Links and their tips side by side against those one by one, observed or not: a lane gives the same bits
// whatever its neighbours are. Friction in floats: what friction changes in the whole right-hand side but for rounding, and the same bits
// however it is computed.

/// Link by link: slopes, then the reactions of those that touch, as far as the pulleys read them.
std::vector<double> outcome(const Variator& variator, const oracle::RandomState& random, int first, int last, bool observe) {
    const ChainLayout& at = variator.layout();
    EvaluationScratch scratch(at);
    fill_window(variator, random.state.data(), scratch);
    if (at.pulley_size != 0) variator.pulleys().motions(random.state.data() + at.pulley_begin(), scratch.sheaves);
    const ChainRange range{first, last, scratch.window.data() + at.link_begin(first), scratch.sheaves, random.phases.data()};
    std::vector<double> slopes(static_cast<std::size_t>(at.link_begin(last - first))), all;
    if (observe) {
        variator.chain().observed_slopes(range, slopes.data(), scratch.loads.data(), scratch.accounts.data());
    } else {
        variator.chain().slopes(range, slopes.data(), scratch.loads.data());
    }
    for (int link = first; link < last; ++link) {
        const double* slope = slopes.data() + at.link_begin(link - first);
        all.insert(all.end(), slope, slope + at.link_block());
        const Phase* tips = random.phases.data() + tips_per_link * link;
        if (tips[0] == Phase::free && tips[1] == Phase::free && tips[2] == Phase::free && tips[3] == Phase::free) continue;
        const LinkLoad& load = scratch.loads[static_cast<std::size_t>(link - first)];
        for (const auto& pair : {load.load.fz, load.load.mz}) all.insert(all.end(), pair, pair + 2);
        if (at.pulley_size == 36) {  // rigid sheaves only turn and move along z: the others are not written unless observed
            for (const auto& pair : {load.load.fx, load.load.fy, load.load.mx, load.load.my}) all.insert(all.end(), pair, pair + 2);
        }
        all.push_back(load.shaft);
    }
    return all;
}

/// Depths and sliding speeds of the tips, of one link by itself or of links side by side.
std::vector<TipProbe> probes_of(const Variator& variator, const oracle::RandomState& random, int first, int last, bool slip, bool alone) {
    const ChainLayout& at = variator.layout();
    std::vector<TipProbe> probes(static_cast<std::size_t>(last - first));
    if (at.pulley_size == 0) return probes;
    SheaveMotion sheaves[4];
    variator.pulleys().motions(random.state.data() + at.pulley_begin(), sheaves);
    const double* links = random.state.data() + at.link_begin(first);
    if (alone) {
        variator.chain().probe(links, sheaves, slip, probes[0]);
    } else {
        variator.chain().probe_links(links, last - first, sheaves, slip, probes.data());
    }
    return probes;
}

void expect_lanes_equal_links(const Parameters& p, const std::string& name, std::uint64_t seed) {
    const auto random = oracle::random_state(p, seed);
    for (const Isa isa : usable_isas()) {
        const Variator variator(p, isa);
        const int links = variator.layout().links;
        for (const auto& [first, last] : {std::pair{0, links}, {0, 1}, {links - 1, links}, {1, links - 2}, {3, 8}, {5, 13}, {2, 11}}) {
            SCOPED_TRACE(std::string(name_of(isa)) + ", links " + std::to_string(first) + " to " + std::to_string(last) + ", " + name);
            std::vector<double> singles;
            for (int link = first; link < last; ++link) {
                const std::vector<double> one = outcome(variator, random, link, link + 1, true);
                singles.insert(singles.end(), one.begin(), one.end());
            }
            for (const bool flag : {false, true}) {
                const std::vector<double> side_by_side = outcome(variator, random, first, last, flag);
                ASSERT_EQ(side_by_side.size(), singles.size());
                EXPECT_EQ(std::memcmp(side_by_side.data(), singles.data(), singles.size() * sizeof(double)), 0) << "observed: " << flag;
                const std::vector<TipProbe> probes = probes_of(variator, random, first, last, flag, false);
                for (int link = first; link < last; ++link) {
                    const TipProbe alone = probes_of(variator, random, link, link + 1, flag, true)[0];
                    EXPECT_EQ(std::memcmp(&probes[static_cast<std::size_t>(link - first)], &alone, sizeof alone), 0)
                        << link << ", " << flag;
                }
            }
        }
    }
}

TEST(LanePass, LinksSideBySideGiveTheBitsOfLinksOneByOneAtEveryDetail) {
    std::uint64_t seed = 512;
    for (const oracle::Case& one : oracle::all_details(oracle::small_scene())) expect_lanes_equal_links(one.parameters, one.name, ++seed);
}

TEST(LanePass, SoTheyDoWithEveryFrictionLawAndManyPlates) {
    for (const FrictionLaw law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
        for (const int plates : {1, 3, 14, 37}) {
            Parameters p = oracle::small_scene();
            p.detail.friction = law;
            p.detail.stick_slip = law == FrictionLaw::piecewise;
            p.plate.count = plates;
            p.detail.joint_points = plates == 37 ? 16 : 5;
            expect_lanes_equal_links(p, "plates " + std::to_string(plates), 77);
        }
    }
}

Parameters without_friction(Parameters p) {
    p.joint.friction.coefficient = p.tip.friction.coefficient = p.plate.friction.coefficient = 0.0;
    return p;
}

/// A random state, and velocities as far from those of the state as in stages of a step. Nothing is damped, so that contacts recorded at
/// the state's velocities are those of the others.
class FrictionRig {
public:
    FrictionRig(const Parameters& p, std::uint64_t seed, Isa isa = chosen_isa())
        : parameters_(undamped(p)),
          random_(oracle::random_state(parameters_, seed)),
          variator_(parameters_, isa),
          scratch_(variator_.layout()),
          start_(random_.state),
          friction_(make_friction(variator_.chain(), p.detail.stick_slip)),
          field_(variator_.chain()) {
        fill_window(variator_, random_.state.data(), scratch_);
        if (at().pulley_size != 0) variator_.pulleys().motions(random_.state.data() + at().pulley_begin(), scratch_.sheaves);
        for (FloatColumns* columns : {&push_, &velocity_, &slope_}) *columns = FloatColumns(size(), at().links + 2 * at().halo());
        for (int link = 0; link < at().links; ++link) {
            for (int row = 0; row < size(); ++row) {
                double& v = start_[static_cast<std::size_t>(at().link_begin(link) + size() + row)];
                v += 1e-3 * std::sin(1.0 + row + 2.4 * link) * std::abs(v);
            }
        }
    }

    /// @param length of ranges
    void evaluate(int length) {
        for (int first = 0; first < at().links; first += length) {
            const ContactRecord to{start_.data() + at().link_begin(first), field_, push_, velocity_};
            friction_.record(range(first, std::min(first + length, at().links)), {}, to, scratch_.loads.data() + first);
        }
        for (int row = 0; row < size(); ++row) {
            for (int ghost = 0; ghost < at().halo(); ++ghost) {
                *velocity_.at(row, -ghost) = *velocity_.at(row, at().links - ghost);
                *velocity_.at(row, at().links + 1 + ghost) = *velocity_.at(row, 1 + ghost);
            }
        }
        for (int first = 0; first < at().links; first += length) {
            const int last = std::min(first + length, at().links);
            std::vector<float> memory(static_cast<std::size_t>(friction_.scratch_size(last - first)));
            friction_.slopes(field_, {first, last, velocity_.at(0, first), velocity_.stride(), memory.data(), random_.phases.data(), 0.25},
                             {nullptr, &slope_});
        }
    }

    [[nodiscard]] std::vector<double> slopes() const { return listed(slope_); }
    [[nodiscard]] std::vector<double> forces() const { return listed(push_); }
    /// slopes() in doubles: the difference that friction makes in the whole right-hand side.
    [[nodiscard]] std::vector<double> exact_slopes() const {
        std::vector<double> with = accelerations(parameters_, start_), without = accelerations(without_friction(parameters_), start_);
        for (std::size_t k = 0; k < with.size(); ++k) with[k] -= without[k];
        return with;
    }
    [[nodiscard]] std::vector<double> exact_forces() const { return accelerations(without_friction(parameters_), random_.state); }
    [[nodiscard]] const ChainLayout& at() const { return variator_.layout(); }

private:
    [[nodiscard]] static Parameters undamped(Parameters p) {
        p.chain.damping_ratio = 0.0;
        return p;
    }
    [[nodiscard]] int size() const { return at().link_size(); }
    [[nodiscard]] ChainRange range(int first, int last) const {
        return {first, last, scratch_.window.data() + first * at().link_block(), scratch_.sheaves, random_.phases.data()};
    }
    [[nodiscard]] std::vector<double> accelerations(const Parameters& p, const std::vector<double>& state) const {
        const Variator variator(p);
        EvaluationScratch scratch(variator.layout());
        std::vector<double> slope(state.size()), all;
        right_hand_side(variator, 0.0, state.data(), random_.phases.data(), slope.data(), scratch);
        for (int link = 0; link < at().links; ++link) {
            const double* first = slope.data() + at().link_begin(link) + size();
            all.insert(all.end(), first, first + size());
        }
        return all;
    }
    [[nodiscard]] std::vector<double> listed(const FloatColumns& columns) const {
        std::vector<double> all;
        for (int link = 0; link < at().links; ++link) {
            for (int row = 0; row < size(); ++row) all.push_back(*columns.at(row, link + 1));
        }
        return all;
    }

    Parameters parameters_;
    oracle::RandomState random_;
    Variator variator_;
    EvaluationScratch scratch_;
    std::vector<double> start_;
    FrictionOperator friction_;
    ContactField field_;
    FloatColumns push_, velocity_, slope_;
};

double largest_of(const std::vector<double>& numbers) {
    double largest = 0.0;
    for (const double x : numbers) largest = std::max(largest, std::abs(x));
    return largest;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
    return largest;
}

std::vector<oracle::Case> cases() {
    std::vector<oracle::Case> cases;
    for (const bool stick_slip : {false, true}) {
        for (const FrictionLaw law : {FrictionLaw::piecewise, FrictionLaw::smoothed}) {
            Parameters p = oracle::small_scene();
            p.detail.stick_slip = stick_slip;
            p.detail.friction = law;
            p.detail.joint_points = stick_slip ? 3 : 8;
            cases.push_back(
                {std::string(stick_slip ? "stick and slip, " : "") + (law == FrictionLaw::smoothed ? "smoothed" : "piecewise"), p});
        }
    }
    cases.push_back({"the baseline, longer than what is computed together", Parameters{}});
    return cases;
}

/// A float has 6e-8 of itself; forces of the contacts of a link, some of which cancel, are added up: 2e-6 of the largest. A joint's depth δ
/// has ρ φ²/4δ times the rounding where links meet at an angle φ: ten times as much with sixteen pins.
TEST(FrictionKernels, GiveFrictionAndAllOtherForcesButForRounding) {
    std::uint64_t seed = 512;
    for (const oracle::Case& one : cases()) {
        FrictionRig rig(one.parameters, ++seed);
        rig.evaluate(rig.at().links);
        const std::vector<double> slopes = rig.exact_slopes(), forces = rig.exact_forces();
        const double rounding = rig.at().links > 16 ? 2e-6 : 2e-5;
        ASSERT_GT(largest_of(slopes), 0.0);
        EXPECT_LT(largest_difference(rig.slopes(), slopes), rounding * largest_of(slopes)) << one.name;
        EXPECT_LT(largest_difference(rig.forces(), forces), rounding * largest_of(forces)) << one.name;
    }
}

TEST(FrictionKernels, GiveTheSameBitsForRangesOfAnyLengthAndEveryInstructionSet) {
    std::uint64_t seed = 600;
    for (const oracle::Case& one : cases()) {
        FrictionRig whole(one.parameters, ++seed);
        whole.evaluate(whole.at().links);
        for (const int length : cvtflow::test::depth(std::vector{1, 5, 8}, std::vector{1, 2, 3, 5, 8, 11})) {
            FrictionRig cut(one.parameters, seed);
            cut.evaluate(length);
            EXPECT_EQ(cut.slopes(), whole.slopes()) << one.name << ", ranges of " << length;
            EXPECT_EQ(cut.forces(), whole.forces()) << one.name << ", ranges of " << length;
        }
        for (const Isa isa : usable_isas()) {
            FrictionRig other(one.parameters, seed, isa);
            other.evaluate(other.at().links);
            EXPECT_EQ(other.slopes(), whole.slopes()) << one.name << ", " << name_of(isa);
        }
    }
}

// Which tips touch, as a record of contacts finds them. (Friction by its kernels: tests/model/kernels/kernels_test.cpp)

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
