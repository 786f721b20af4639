#include "bench/study/profile/trace.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace cvtflow::bench {

using namespace tasks;
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST(Trace, IsJsonWithASpanPerTask) {
    Profile profile;
    profile.results.resize(2);  // the first was not recorded
    Recording& recording = profile.results[1].recording;
    recording.tasks = {"force[0]", "force[1]"};
    recording.spans = {{{engine::span_enter, 100, 110}, {0, 110, 200}, {engine::span_controller, 200, 210}, {engine::span_exit, 210, 220}},
                       {{engine::span_enter, 100, 120}, {1, 120, 190}, {engine::span_wait, 190, 195}, {engine::span_exit, 195, 220}}};
    const auto json = nlohmann::json::parse(profile_trace(profile));
    const auto& events = json["traceEvents"];
    ASSERT_EQ(events.size(), 2u + 8u);  // a name per schedule, and all spans
    EXPECT_EQ(events[3]["name"], "force[0]");
    EXPECT_DOUBLE_EQ(events[3]["ts"], 0.01);  // us after the first span
    EXPECT_DOUBLE_EQ(events[3]["dur"], 0.09);
    EXPECT_EQ(events[7]["tid"], 1);
}

TEST(HashDifferences, AreFoundAtEqualNumbersOfSteps) {
    std::vector<ScheduleResult> results(3);
    for (ScheduleResult& result : results) result.hash_steps = 40, result.hash = 77, result.name = "x:fused";
    results[2].hash_steps = 4;  // slow: compared earlier
    results[2].hash = 55;
    EXPECT_THAT(hash_differences(results, 55), IsEmpty());
    EXPECT_THAT(hash_differences(results, 56), SizeIs(1));
    results[1].hash = 78;
    results[1].name = "flow:staged";
    ASSERT_THAT(hash_differences(results, 55), SizeIs(1));
    EXPECT_THAT(hash_differences(results, 55)[0], HasSubstr("flow:staged"));
}

}  // namespace
}  // namespace cvtflow::bench
