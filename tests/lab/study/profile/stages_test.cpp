#include "bench/study/profile/stages.hpp"

#include <gmock/gmock.h>

#include <set>

#include "tasks/method/method.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step/step_graph.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

/// Three segments of the scene tiny with tasks of a method.
class GraphOf {
public:
    GraphOf(const Scene& scene, const std::string& method, const AssemblyOptions& options)
        : workspace_(scene.parameters, Method(method).plan(), Partition::equal(scene.parameters.chain.pins, 3)),
          method_(Method(method).make(workspace_)) {
        graph_ = step_graph(workspace_, options, method_.get());
    }
    [[nodiscard]] const engine::TaskGraph& graph() const { return graph_; }

private:
    Workspace workspace_;
    std::unique_ptr<StepMethod> method_;
    engine::TaskGraph graph_;
};

TEST(Stages, EveryTaskOfEveryMethodHasOneWithALetterOfItsOwn) {
    for (const std::string& method : method_names()) {
        StageTable stages;
        Scene scene = ready_tiny();
        if (!objection_to(method, scene.parameters).empty()) apply_detail(scene, "rigid");
        for (const Assembly kind : {Assembly::fused, Assembly::staged}) stages.add(GraphOf(scene, method, {kind}).graph());
        std::set<std::string> names;
        std::set<char> letters;
        for (const StageRow& row : stages.rows()) {
            EXPECT_TRUE(names.insert(row.name).second) << method << " " << row.name;
            EXPECT_TRUE(letters.insert(row.letter).second) << method << " " << row.name;
        }
        for (const Assembly kind : {Assembly::fused, Assembly::staged}) {
            const GraphOf of(scene, method, {kind});
            for (int task = 0; task < of.graph().size(); ++task) {
                const StageRow& row = stages.rows()[stages.row(of.graph().task(task).stage_name())];
                EXPECT_TRUE(row.task) << method;
                const int cycle = of.graph().task(task).cycle;
                EXPECT_EQ(row.name == "transition", cycle > evaluate_cycle && cycle < observe_cycle)
                    << method << " " << of.graph().task(task).name;
            }
        }
    }
}

TEST(Stages, AreNamedByTheTasks) {
    const Scene scene = ready_tiny();
    const auto names = [](const GraphOf& of) {
        StageTable stages;
        stages.add(of.graph());
        std::vector<std::string> list;
        for (const StageRow& row : stages.rows()) list.push_back(row.name);
        return list;
    };
    using testing::ElementsAre;
    EXPECT_THAT(names({scene, "rk4", {}}),
                ElementsAre("enter", "all forces (fused)", "transition", "observe", "controller", "wait", "exit"));
    EXPECT_THAT(names({scene, "rk4", {Assembly::staged}}),
                ElementsAre("enter", "combine", "contact forces", "chain forces", "boundary pins", "Cholesky", "observe", "transition",
                            "controller", "wait", "exit"));
    EXPECT_THAT(names({scene, "leapfrog-sweep", {}}), ElementsAre("enter", "all forces (fused)", "transition", "observe", "record",
                                                                  "friction", "book", "controller", "wait", "exit"));
    EXPECT_THAT(names({scene, "trapezoidal-full", {Assembly::staged}}),
                testing::AllOf(testing::Contains("Cholesky"), testing::Contains("jacobian"), testing::Contains("backward")));
}

TEST(Stages, OfOtherGraphsAreRefused) { EXPECT_THROW(static_cast<void>(StageTable().row("record")), std::invalid_argument); }

void nothing(void*, int) noexcept {}

/// Two cycles of two tasks on two threads: 0 runs tasks of 30 and 20 ns, 1 of 10 and 20; the controller works 5 ns each time.
///
///     thread 0   enter 0-10  controller 10-15  task 15-45  wait 45-47  controller 47-52  task 52-72  controller 74-79  exit 79-80
///     thread 1   enter 0-16                    task 16-26  wait ───────────────── 53     task 53-73                  exit 73-80
class TwoThreads : public testing::Test {
protected:
    TwoThreads() {
        for (const int item : {0, 1}) graph_.add({"force[" + std::to_string(item) + "]", 0, nothing, item, {}});
        graph_.freeze();
        stages_.add(graph_);
    }
    engine::TaskGraph graph_;
    StageTable stages_;
    Spans spans_{{{engine::span_enter, 0, 10},
                  {engine::span_controller, 10, 15},
                  {0, 15, 45},
                  {engine::span_wait, 45, 47},
                  {engine::span_controller, 47, 52},
                  {0, 52, 72},
                  {engine::span_wait, 72, 74},
                  {engine::span_controller, 74, 79},
                  {engine::span_exit, 79, 80}},
                 {{engine::span_enter, 0, 16}, {1, 16, 26}, {engine::span_wait, 26, 53}, {1, 53, 73}, {engine::span_exit, 73, 80}}};
};

TEST_F(TwoThreads, AreSummedByStage) {
    const RecordedPass pass = sum_up(graph_, stages_, spans_);
    ASSERT_EQ(pass.threads.size(), 2u);
    EXPECT_DOUBLE_EQ(pass.wall, 80e-9);
    EXPECT_DOUBLE_EQ(pass.cycles, 2.0);
    EXPECT_DOUBLE_EQ(pass.levels, 2.0);
    EXPECT_DOUBLE_EQ(pass.task_count, 4.0);
    EXPECT_DOUBLE_EQ(pass.threads[0].at(stages_.row("force")), 50e-9);
    EXPECT_DOUBLE_EQ(pass.threads[1].wait(), 27e-9);
    EXPECT_DOUBLE_EQ(pass.controller(), 15e-9);
    for (const ThreadTimes& thread : pass.threads) EXPECT_DOUBLE_EQ(thread.total(), 80e-9);
}

TEST_F(TwoThreads, LoseWhatIsNeitherTaskNorController) {
    const RecordedPass pass = sum_up(graph_, stages_, spans_);
    EXPECT_EQ(pass.active(), 2);
    EXPECT_NEAR(pass.synchronisation(), (2e-9 + 2e-9 + 27e-9 - 15e-9) / (2 * 2), 1e-18);
    EXPECT_NEAR(pass.min_task(), pass.synchronisation(), 1e-18);  // one level per cycle
    EXPECT_NEAR(pass.imbalance(), 50.0 / 40.0, 1e-12);
}

TEST_F(TwoThreads, OneThatNeverCameIsImbalanceAndNotSynchronisation) {
    spans_[1] = {{engine::span_enter, 0, 80}, {engine::span_exit, 80, 80}};
    const RecordedPass pass = sum_up(graph_, stages_, spans_);
    EXPECT_EQ(pass.active(), 1);
    EXPECT_NEAR(pass.imbalance(), 2.0, 1e-12);
    EXPECT_NEAR(pass.synchronisation(), 4e-9 / pass.cycles, 1e-18);
    EXPECT_NEAR(pass.serial_share(), 19.0 / 69.0, 1e-9);
}

TEST(Stages, NothingRecordedIsZero) {
    const RecordedPass none;
    EXPECT_EQ(none.synchronisation(), 0.0);
    EXPECT_EQ(none.min_task(), 0.0);
    EXPECT_EQ(none.imbalance(), 1.0);
    EXPECT_EQ(none.serial_share(), 0.0);
}

}  // namespace
}  // namespace cvtflow::bench
