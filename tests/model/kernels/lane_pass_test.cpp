/// Links side by side against links one by one, observed or not: a lane gives the same bits whatever its neighbours are.

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"
#include "tests/oracle/random_state.hpp"

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

std::vector<double> one_by_one(const Variator& variator, const oracle::RandomState& random, int first, int last) {
    std::vector<double> all;
    for (int link = first; link < last; ++link) {
        const std::vector<double> one = outcome(variator, random, link, link + 1, true);
        all.insert(all.end(), one.begin(), one.end());
    }
    return all;
}

void expect_lanes_equal_links(const Parameters& p, const std::string& name, std::uint64_t seed) {
    const auto random = oracle::random_state(p, seed);
    for (const Isa isa : usable_isas()) {
        const Variator variator(p, isa);
        const int links = variator.layout().links;
        for (const auto& [first, last] : {std::pair{0, links}, {0, 1}, {links - 1, links}, {1, links - 2}, {3, 8}, {5, 13}, {2, 11}}) {
            const std::vector<double> singles = one_by_one(variator, random, first, last);
            for (const bool observe : {false, true}) {
                const std::vector<double> side_by_side = outcome(variator, random, first, last, observe);
                ASSERT_EQ(side_by_side.size(), singles.size());
                EXPECT_EQ(std::memcmp(side_by_side.data(), singles.data(), singles.size() * sizeof(double)), 0)
                    << name_of(isa) << ", links " << first << " to " << last << ", " << name << (observe ? ", observed" : "");
            }
        }
    }
}

TEST(LanePass, LinksSideBySideGiveTheBitsOfLinksOneByOneAtEveryDetail) {
    std::uint64_t seed = 500;
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

}  // namespace
}  // namespace cvtflow::model
