#include "bench/study/profile/report.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

namespace cvtflow::bench {

using namespace tasks;
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Cells of a line of CSV.
std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> result{""};
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') quoted = !quoted;
        if (c == ',' && !quoted) {
            result.emplace_back();
        } else {
            result.back() += c;
        }
    }
    return result;
}

/// Two schedules, the second recorded on two threads and dropped under load.
class Report : public testing::Test {
protected:
    Report() {
        scene_.name = "odd \"name\", with comma";
        ScheduleResult serial, flow;
        serial.name = "serial:fused";
        serial.loads = {{0, {1e-4, 1.1e-4, 1.2e-4}, 2.5e-5, 1.0, 1.0, 5, ""}, {1, {2e-4, 2e-4, 2e-4}, 5e-5, 1.0, 1.0, 5, ""}};
        flow.name = "flow:fused";
        flow.schedule.executor = "flow";
        flow.schedule.threads = flow.schedule.segments = 2;
        flow.loads = {{0, {5e-5, 6e-5, 7e-5}, 1.5e-5, 1.9, 1.83, 5, ""}, {1, {}, 0.0, 0.0, 0.0, 0, "dropped: 4 steps took 3.0 s"}};
        flow.recording.tasks = {"force[0]", "force[1]"};
        flow.recording.spans = {
            {{engine::span_enter, 100, 110}, {0, 110, 200}, {engine::span_controller, 200, 210}, {engine::span_exit, 210, 220}},
            {{engine::span_enter, 100, 120}, {1, 120, 190}, {engine::span_wait, 190, 195}, {engine::span_exit, 195, 220}}};
        profile_.results = {serial, flow};
        profile_.bare = {{2, 1.8e-7}};
    }
    Scene scene_;
    Profile profile_;
};

TEST_F(Report, CsvHasARowPerScheduleAndLoadOfEqualWidth) {
    std::istringstream lines(profile_csv(scene_, profile_));
    std::string line;
    std::vector<std::vector<std::string>> rows;
    while (std::getline(lines, line)) rows.push_back(cells(line));
    ASSERT_THAT(rows, SizeIs(1 + 4));
    for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
    EXPECT_EQ(rows[0][1], "schedule");
    EXPECT_EQ(rows[3][1], "flow:fused");
    EXPECT_EQ(rows[3][7], "60.0000");  // median step [us]
}

TEST_F(Report, StagesHaveARowPerScheduleThreadAndStage) {
    engine::TaskGraph graph;
    graph.add({"force[0]", 0, [](void*, int) noexcept {}, 0, {}, "all forces (fused)"});
    graph.freeze();
    profile_.stages.add(graph);  // enter, all forces, controller, wait, exit
    profile_.results[1].recording.pass.threads = {{{}}, {{0.0, 3e-6, 0.0, 1e-6, 0.0}}};
    profile_.results[1].recording.steps = 2;
    std::istringstream lines(profile_stages_csv(scene_, profile_));
    std::string line;
    std::vector<std::vector<std::string>> rows;
    while (std::getline(lines, line)) rows.push_back(cells(line));
    ASSERT_THAT(rows, SizeIs(1 + 2 * 5));  // serial was not recorded
    EXPECT_EQ(rows[1 + 5 + 1][5], "\"all forces (fused)\"");
    EXPECT_EQ(rows[1 + 5 + 1][7], "0.75000");
    EXPECT_EQ(rows[1 + 5 + 1][8], "1.5000");  // [us] per step
}

TEST_F(Report, TraceIsJsonWithASpanPerTask) {
    const auto json = nlohmann::json::parse(profile_trace(profile_));
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
