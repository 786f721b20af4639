/// Kernels of every instruction set. Links and their tips side by side against those one by one, observed or not: a lane gives the same
/// bits whatever its neighbours are. Friction in floats: what friction changes in the whole right-hand side but for rounding, and the same
/// bits however it is computed. Links at a step's end, against a plain loop.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "model/contact/friction_operator.hpp"
#include "model/contact/friction_stage.hpp"
#include "model/kernels/available_isas.hpp"
#include "model/kernels/kernels.hpp"
#include "model/kernels/step_end.hpp"
#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/random_state.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::model {
namespace {

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

constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
constexpr double limit = 1e4, step = 2e-6;

/// Links with numbers that are drawn, one more block of canaries behind them.
struct Links {
    int links, size;
    FloatColumns velocity;
    std::vector<double> counted_from, start, end, secants;

    explicit Links(int links_) : links(links_), size(ChainLayout{}.link_size()), velocity(size, links + 2) {
        std::mt19937_64 chance(7);
        std::uniform_real_distribution<double> drawn(-9.0, 9.0);
        for (std::vector<double>* each : {&counted_from, &start, &end, &secants}) {
            each->resize(static_cast<std::size_t>(2 * size * (links + 1)));
            for (double& number : *each) number = drawn(chance);
        }
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < velocity.stride() - 1; ++column) *velocity.at(row, column) = static_cast<float>(nan);
            for (int link = 0; link < links; ++link) *velocity.at(row, 1 + link) = static_cast<float>(drawn(chance));
        }
    }

    bool finish(Isa isa, bool with_secants) {
        return kernels_of(isa).friction().end({velocity.at(0, 1), velocity.stride(), counted_from.data(), start.data(), end.data(),
                                               with_secants ? secants.data() : nullptr, step, limit},
                                              links);
    }
    /// finish() number by number.
    void finish_plainly(bool with_secants) {
        for (int link = 0; link < links; ++link) {
            for (int row = 0; row < size; ++row) {
                const auto q = static_cast<std::size_t>(2 * size * link + row), v = q + static_cast<std::size_t>(size);
                end[v] = *velocity.at(row, 1 + link) + counted_from[v];
                end[q] = start[q] + 0.5 * step * (start[v] + end[v]);
                if (!with_secants) continue;
                secants[q] = end[v];
                secants[v] = (end[v] - start[v]) / step;
            }
        }
    }
};

void expect_plain_bits(int links, bool with_secants) {
    Links plain(links);
    plain.finish_plainly(with_secants);
    for (const Isa isa : usable_isas()) {
        Links computed(links);
        EXPECT_TRUE(computed.finish(isa, with_secants)) << "NaN beside the links has no effect";
        for (const auto& [is, expected] : {std::pair{&computed.end, &plain.end}, {&computed.secants, &plain.secants}}) {
            EXPECT_EQ(std::memcmp(is->data(), expected->data(), is->size() * sizeof(double)), 0)
                << name_of(isa) << ", " << links << " links";
        }
    }
}

TEST(StepEnd, HasTheBitsOfAPlainLoopForEveryNumberOfLinks) {
    for (int links = 1; links <= 33; ++links) expect_plain_bits(links, links % 2 == 0);
}

/// Whether links are sound of which one number is another one.
bool sound_with(Isa isa, int link, bool coordinate, double number) {
    constexpr int links = 19;
    Links computed(links);
    const int place = 2 * computed.size * link + 5;
    if (coordinate) {
        computed.start[static_cast<std::size_t>(place)] = number;
    } else {  // nothing but what it counts from: a float cannot have every double
        *computed.velocity.at(5, 1 + link) = 0.0F;
        computed.counted_from[static_cast<std::size_t>(place + computed.size)] = number;
    }
    return computed.finish(isa, true);
}

TEST(StepEnd, NoticesEveryNumberThatIsBeyondTheLimitOrNone) {
    const double beyond = std::nextafter(limit, infinity);
    for (const Isa isa : usable_isas()) {
        for (const int link : {0, 7, 18}) {
            for (const double sign : {-1.0, 1.0}) {
                EXPECT_TRUE(sound_with(isa, link, false, sign * limit)) << "the limit itself";
                EXPECT_FALSE(sound_with(isa, link, false, sign * beyond));
                for (const bool coordinate : {false, true}) EXPECT_FALSE(sound_with(isa, link, coordinate, sign * infinity));
                EXPECT_FALSE(sound_with(isa, link, true, sign * 1.1 * limit));
            }
            for (const bool coordinate : {false, true}) {
                EXPECT_FALSE(sound_with(isa, link, coordinate, nan));
                EXPECT_TRUE(sound_with(isa, link, coordinate, 1e-310)) << "denormal";
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
