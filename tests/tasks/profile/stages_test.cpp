#include "tasks/profile/stages.hpp"

#include <gtest/gtest.h>

#include "engine/method/catalogue.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/step_graph.hpp"

namespace cvtflow::tasks {
namespace {

TEST(Stages, EveryTaskOfEveryGraphHasOne) {
    const Scene scene = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml", StartState::ignored);
    const Workspace workspace(scene.parameters, *engine::find_method("rk4"), Partition::equal(scene.parameters.chain.pins, 3));
    for (const Assembly kind : {Assembly::fused, Assembly::staged}) {
        for (const bool parallel : {false, true}) {
            const engine::TaskGraph graph = step_graph(workspace, {kind, parallel, parallel});
            for (int task = 0; task < graph.size(); ++task) {
                const Stage stage = stage_of(graph.task(task).name);
                EXPECT_TRUE(stages()[static_cast<std::size_t>(stage)].task) << graph.task(task).name;
                EXPECT_EQ(stage == Stage::transition, graph.task(task).cycle != evaluate_cycle) << graph.task(task).name;
            }
        }
    }
}

TEST(Stages, AreNamedAfterTheTask) {
    EXPECT_EQ(stage_of("force[3]"), Stage::force);
    EXPECT_EQ(stage_of("contact[0]"), Stage::contact);
    EXPECT_EQ(stage_of("forward"), Stage::cholesky);
    EXPECT_EQ(stage_of("reverse[12]"), Stage::cholesky);
    EXPECT_EQ(stage_of("truncate[1]"), Stage::transition);
    EXPECT_THROW(static_cast<void>(stage_of("forces")), std::invalid_argument);
}

TEST(Stages, RowsAreInOrder) {
    for (std::size_t k = 0; k < stages().size(); ++k) EXPECT_EQ(static_cast<std::size_t>(stages()[k].stage), k);
}

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
    }
    engine::TaskGraph graph_;
    Spans spans_{{{engine::span_enter, 0, 10}, {engine::span_controller, 10, 15}, {0, 15, 45}, {engine::span_wait, 45, 47}, {engine::span_controller, 47, 52}, {0, 52, 72},
                  {engine::span_wait, 72, 74}, {engine::span_controller, 74, 79}, {engine::span_exit, 79, 80}},
                 {{engine::span_enter, 0, 16}, {1, 16, 26}, {engine::span_wait, 26, 53}, {1, 53, 73}, {engine::span_exit, 73, 80}}};
};

TEST_F(TwoThreads, AreSummedByStage) {
    const RecordedPass pass = sum_up(graph_, spans_);
    ASSERT_EQ(pass.threads.size(), 2u);
    EXPECT_DOUBLE_EQ(pass.wall, 80e-9);
    EXPECT_DOUBLE_EQ(pass.cycles, 2.0);
    EXPECT_DOUBLE_EQ(pass.levels, 2.0);
    EXPECT_DOUBLE_EQ(pass.task_count, 4.0);
    EXPECT_DOUBLE_EQ(pass.threads[0].at(Stage::force), 50e-9);
    EXPECT_DOUBLE_EQ(pass.threads[1].at(Stage::wait), 27e-9);
    EXPECT_DOUBLE_EQ(pass.sum(Stage::controller), 15e-9);
    for (const ThreadTimes& thread : pass.threads) EXPECT_DOUBLE_EQ(thread.total(), 80e-9);
}

TEST_F(TwoThreads, LoseWhatIsNeitherTaskNorController) {
    const RecordedPass pass = sum_up(graph_, spans_);
    EXPECT_EQ(pass.active(), 2);
    EXPECT_NEAR(pass.synchronisation(), (2e-9 + 2e-9 + 27e-9 - 15e-9) / (2 * 2), 1e-18);
    EXPECT_NEAR(pass.least_task(), pass.synchronisation(), 1e-18);   // one level per cycle
    EXPECT_NEAR(pass.imbalance(), 50.0 / 40.0, 1e-12);
}

TEST_F(TwoThreads, OneThatNeverCameIsImbalanceAndNotSynchronisation) {
    spans_[1] = {{engine::span_enter, 0, 80}, {engine::span_exit, 80, 80}};
    const RecordedPass pass = sum_up(graph_, spans_);
    EXPECT_EQ(pass.active(), 1);
    EXPECT_NEAR(pass.imbalance(), 2.0, 1e-12);
    EXPECT_NEAR(pass.synchronisation(), 4e-9 / pass.cycles, 1e-18);
    EXPECT_NEAR(pass.serial_share(), 19.0 / 69.0, 1e-9);
}

TEST(Stages, NothingRecordedIsZero) {
    const RecordedPass none;
    EXPECT_EQ(none.synchronisation(), 0.0);
    EXPECT_EQ(none.least_task(), 0.0);
    EXPECT_EQ(none.imbalance(), 1.0);
    EXPECT_EQ(none.serial_share(), 0.0);
}

}  // namespace
}  // namespace cvtflow::tasks
