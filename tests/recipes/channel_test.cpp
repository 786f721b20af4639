/// Recipe "a channel": one row of tasks/channel/channels.cpp.

#include <gtest/gtest.h>

#include "tasks/channel/channels.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::recipes {
namespace {

/// Sum of the tensions of both strands.
double sum_of_strands(const tasks::Instant& now) { return now.observation.tight + now.observation.slack; }
const tasks::Channel strand_sum{"strands/sum", "N", "tension of both strands together", sum_of_strands};

TEST(ChannelRecipe, ReadsWhatItSaysAndWritesItsWidth) {
    claims::Rig rig(tasks::tiny_parameters());
    model::Observer observer(rig.variator());
    const model::Observation& observation = observer.observe(rig.time(), rig.state(), rig.phases().data());
    double values[]{0.0, -1.0};
    strand_sum.read({observation, rig.workspace(), rig.counters(), 0, observer}, values);
    EXPECT_EQ(strand_sum.width(rig.variator().chain()), 1);
    EXPECT_EQ(values[0], observation.tight + observation.slack);
    EXPECT_EQ(values[1], -1.0);
}

}  // namespace
}  // namespace cvtflow::recipes
