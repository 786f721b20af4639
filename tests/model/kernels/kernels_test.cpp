#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/friction_operator.hpp"
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

TEST(LinkPass, LinksSideBySideGiveTheBitsOfLinksOneByOneAtEveryDetail) {
    std::uint64_t seed = 512;
    for (const oracle::Case& one : oracle::all_details(oracle::small_scene())) expect_lanes_equal_links(one.parameters, one.name, ++seed);
}

TEST(LinkPass, SoTheyDoWithEveryFrictionLawAndManyPlates) {
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

/// A random state, and velocities near those of the state. Nothing is damped, so that contacts recorded at the state's velocities are those
/// of the others.
class FrictionRig {
public:
    FrictionRig(const Parameters& p, std::uint64_t seed, Isa isa = chosen_isa())
        : parameters_(undamped(p)),
          random_(oracle::random_state(parameters_, seed)),
          variator_(parameters_, isa),
          scratch_(variator_.layout()),
          start_(random_.state),
          friction_(make_friction(variator_.chain())),
          field_(variator_.chain()) {
        fill_window(variator_, random_.state.data(), scratch_);
        if (at().pulley_size != 0) variator_.pulleys().motions(random_.state.data() + at().pulley_begin(), scratch_.sheaves);
        for (FloatColumns* columns : {&push_, &start_velocity_, &velocity_, &result_}) *columns = FloatColumns(size(), at().links + 2);
        const int kept = SweepRows{variator_.chain().coefficients().joint_points.count}.count();
        for (FloatColumns* columns : {&kept_, &before_}) *columns = FloatColumns(kept, at().links + 2);
        mean_tip_forces_ = FloatColumns(3 * tips_per_link, at().links + 2);
        for (int link = 0; link < at().links; ++link) {
            for (int row = 0; row < size(); ++row) {
                double& v = start_[static_cast<std::size_t>(at().link_begin(link) + size() + row)];
                v += 1e-3 * std::sin(1.0 + row + 2.4 * link) * std::abs(v);
            }
        }
    }

    /// Links are held and waves filtered, as in steps of this length [s].
    void hold(double step) { friction_.hold(static_cast<float>(step)); }
    /// Contacts, and all other forces. @param length of ranges
    void record(int length) {
        for (int first = 0; first < at().links; first += length) {
            const ContactRecord to{start_.data() + at().link_begin(first), field_, push_, start_velocity_};
            friction_.record(range(first, std::min(first + length, at().links)), {}, to, scratch_.loads.data() + first);
        }
    }
    /// Velocities at the end of a step by `sweeps` sweeps that begin with no forces. step [s]
    void sweep(double step, int sweeps) {
        const SweepResponses responses(friction_, step, step);
        std::vector<float> memory(static_cast<std::size_t>(friction_.scratch_size(at().links)));
        for (int pass = 0; pass <= sweeps; ++pass) {
            for (FloatColumns* columns : {&start_velocity_, &velocity_, &push_}) close(*columns);
            const SweepPart part = pass == 0 ? SweepPart::opening : pass == sweeps ? SweepPart::closing : SweepPart::middle;
            const FrictionRange links{0, at().links, velocity_.at(0, 0), velocity_.stride(), memory.data(), random_.phases.data(), 0.0};
            friction_.kernels().sweep(
                friction_, field_, links,
                {part, 0.0F, &responses, &push_, &start_velocity_, &before_, &kept_, &velocity_, &result_, &mean_tip_forces_});
        }
    }
    /// Accelerations by friction that the velocities at the step's end tell, and those by the law at `sweep_time`, in doubles.
    [[nodiscard]] std::pair<std::vector<double>, std::vector<double>> swept_and_lawful(double step) const {
        std::vector<double> swept, state = random_.state;
        for (int link = 0; link < at().links; ++link) {
            for (int row = 0; row < size(); ++row) {
                const double begin = *start_velocity_.at(row, link + 1), end = *result_.at(row, link + 1);
                swept.push_back((end - begin) / step - *push_.at(row, link + 1));
                state[static_cast<std::size_t>(at().link_begin(link) + size() + row)] += begin + sweep_time * (end - begin);
            }
        }
        std::vector<double> lawful = accelerations(parameters_, state), without = accelerations(without_friction(parameters_), state);
        for (std::size_t k = 0; k < lawful.size(); ++k) lawful[k] -= without[k];
        return {swept, lawful};
    }

    [[nodiscard]] std::vector<double> forces() const { return listed(push_); }
    [[nodiscard]] std::vector<double> velocities() const { return listed(result_); }
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
    /// The columns beside the links repeat the last and the first link.
    void close(FloatColumns& columns) const {
        for (int row = 0; row < size(); ++row) {
            *columns.at(row, 0) = *columns.at(row, at().links);
            *columns.at(row, at().links + 1) = *columns.at(row, 1);
        }
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
    FloatColumns push_, start_velocity_, velocity_, result_, kept_, before_, mean_tip_forces_;
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
    Parameters points = oracle::small_scene(), three = points;
    points.detail.joint_points = 8;
    three.detail.joint_points = 3;
    Parameters corner = points;
    corner.detail.friction = FrictionLaw::smoothed, corner.detail.smoothing = 0.5;
    return {{"eight points", points},
            {"three points", three},
            {"eight points, a rounded corner", corner},
            {"the baseline, longer than what is computed together", Parameters{}}};
}

/// A float has 6e-8 of itself; forces of the contacts of a link, some of which cancel, are added up: 2e-6 of the largest. A joint's depth δ
/// has ρ φ²/4δ times the rounding where links meet at an angle φ: ten times as much with sixteen pins.
TEST(FrictionKernels, RecordAllOtherForcesButForRounding) {
    std::uint64_t seed = 512;
    for (const oracle::Case& one : cases()) {
        FrictionRig rig(one.parameters, ++seed);
        rig.record(rig.at().links);
        const std::vector<double> forces = rig.exact_forces();
        EXPECT_LT(largest_difference(rig.forces(), forces), (rig.at().links > 16 ? 2e-6 : 2e-5) * largest_of(forces)) << one.name;
    }
}

/// Sweeps that continue end at the friction of the law.
TEST(FrictionKernels, SweepsConvergeToTheLawsFriction) {
    std::uint64_t seed = 512;
    for (const oracle::Case& one : cases()) {
        FrictionRig rig(one.parameters, ++seed);
        constexpr double step = 1e-6;
        rig.record(rig.at().links);
        rig.sweep(step, 400);
        const auto [swept, lawful] = rig.swept_and_lawful(step);
        ASSERT_GT(largest_of(lawful), 0.0);
        EXPECT_LT(largest_difference(swept, lawful), 1e-3 * largest_of(lawful)) << one.name;
    }
}

TEST(FrictionKernels, GiveTheSameBitsForRangesOfAnyLengthAndEveryInstructionSet) {
    std::uint64_t seed = 600;
    for (const oracle::Case& one : cases()) {
        FrictionRig whole(one.parameters, ++seed);
        whole.hold(5e-6);
        whole.record(whole.at().links);
        for (const int length : cvtflow::test::depth(std::vector{1, 5, 8}, std::vector{1, 2, 3, 5, 8, 11})) {
            FrictionRig cut(one.parameters, seed);
            cut.hold(5e-6);
            cut.record(length);
            EXPECT_EQ(cut.forces(), whole.forces()) << one.name << ", ranges of " << length;
        }
        whole.sweep(1e-6, 2);
        for (const Isa isa : usable_isas()) {
            FrictionRig other(one.parameters, seed, isa);
            other.hold(5e-6);
            other.record(other.at().links);
            other.sweep(1e-6, 2);
            EXPECT_EQ(other.velocities(), whole.velocities()) << one.name << ", " << name_of(isa);
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
    const FrictionOperator friction = make_friction(variator.chain());
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
