/// Recipe "an executor": one class, which must run every task once and no task before those that it waits for.

#include <gtest/gtest.h>

#include <vector>

#include "engine/executor/run.hpp"
#include "engine/graph/task_graph.hpp"

namespace cvtflow::recipes {
namespace {

/// Runs the tasks of a level from the last to the first: allowed, since nothing orders them.
class Backward final : public engine::RunningExecutor {
public:
    explicit Backward(const engine::ExecutorOptions& options = {}) : RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "backward"; }

private:
    void execute(engine::Run& run, int first) override {
        for (int cycle = first; cycle != engine::Controller::stop; cycle = run.decide(0)) {
            for (int level = 0; level < run.graph().levels(cycle); ++level) {
                const auto tasks = run.graph().level(cycle, level);
                for (auto task = tasks.rbegin(); task != tasks.rend(); ++task) run.task(*task, 0);
            }
        }
    }
};

struct Times final : engine::Controller {
    int left;
    explicit Times(int times) : left(times) {}
    int next() noexcept override { return left-- > 0 ? 0 : stop; }
};

TEST(ExecutorRecipe, RunsEveryTaskOncePerCycleAndInOrder) {
    engine::TaskGraph graph;
    const auto note = [](void* context, int item) noexcept { static_cast<std::vector<int>*>(context)->push_back(item); };
    const int first = graph.add({"first", 0, note, 0, {}}), left = graph.add({"left", 0, note, 1, {}}),
              right = graph.add({"right", 0, note, 2, {}});
    const int last = graph.add({"last", 0, note, 3, {}});
    for (const int middle : {left, right}) {
        graph.order(first, middle);
        graph.order(middle, last);
    }
    graph.freeze();
    std::vector<int> seen;
    seen.reserve(8);  // bodies are noexcept
    Times twice(2);
    Backward().run(graph, &seen, twice);
    EXPECT_EQ(seen, (std::vector<int>{0, 2, 1, 3, 0, 2, 1, 3}));
}

TEST(ExecutorRecipe, RefusesAGraphThatIsNotFrozen) {
    engine::TaskGraph graph;
    Times once(1);
    EXPECT_THROW(Backward().run(graph, nullptr, once), std::logic_error);
}

}  // namespace
}  // namespace cvtflow::recipes
