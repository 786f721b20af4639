/// Tips of links side by side against those of one link at a time.

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "model/variator/variator.hpp"
#include "tests/oracle/oracle_cases.hpp"

namespace cvtflow::model {
namespace {

TEST(LaneProbe, GivesTheBitsOfOneLinkAtATimeForRangesOfAnyLength) {
    for (const oracle::Case& one : oracle::all_details(oracle::small_scene())) {
        const auto random = oracle::random_state(one.parameters, 91);
        for (const Isa isa : usable_isas()) {
            const Variator variator(one.parameters, isa);
            const ChainLayout& at = variator.layout();
            if (at.pulley_size == 0) continue;
            SheaveMotion sheaves[4];
            variator.pulleys().motions(random.state.data() + at.pulley_begin(), sheaves);
            for (const bool slip : {false, true}) {
                std::vector<TipProbe> expected(static_cast<std::size_t>(at.links));
                for (int link = 0; link < at.links; ++link)
                    variator.chain().probe(random.state.data() + at.link_begin(link), sheaves, slip,
                                           expected[static_cast<std::size_t>(link)]);
                for (const auto& [first, last] : {std::pair{0, at.links}, {1, 2}, {3, 8}, {2, at.links - 1}}) {
                    std::vector<TipProbe> probes(static_cast<std::size_t>(last - first));
                    variator.chain().probe_links(random.state.data() + at.link_begin(first), last - first, sheaves, slip, probes.data());
                    EXPECT_EQ(std::memcmp(probes.data(), expected.data() + first, probes.size() * sizeof(TipProbe)), 0)
                        << one.name << ", " << name_of(isa) << ", links " << first << " to " << last << ", slip " << slip;
                }
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::model
