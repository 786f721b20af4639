#include "engine/executor/serial.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "tests/engine/allocation_fixture.hpp"
#include "tests/engine/graph/graph_fixture.hpp"

namespace cvtflow::engine {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Names cycles from a list, then stops.
class Script final : public Controller {
public:
    explicit Script(std::vector<int> cycles) : cycles_(std::move(cycles)) {}
    int next() noexcept override { return next_ < cycles_.size() ? cycles_[next_++] : stop; }

private:
    std::vector<int> cycles_;
    std::size_t next_ = 0;
};

TEST(Serial, RunsTasksInTopologicalOrder) {
    std::vector<int> seen;
    Script script({0});
    Serial().run(test::diamond(), &seen, script);
    EXPECT_THAT(seen, ElementsAre(10, 11, 12, 13));
}

TEST(Serial, FollowsTheController) {
    TaskGraph graph;
    graph.add({"a", 0, test::record, 1, {}});
    graph.add({"b", 1, test::record, 2, {}});
    graph.freeze();
    std::vector<int> seen;
    Script script({1, 0, 0, 1});
    Serial().run(graph, &seen, script);
    EXPECT_THAT(seen, ElementsAre(2, 1, 1, 2));
}

TEST(Serial, StopsAtOnceIfAsked) {
    std::vector<int> seen;
    Script script({});
    Serial().run(test::diamond(), &seen, script);
    EXPECT_THAT(seen, IsEmpty());
}

TEST(Serial, UnknownCyclesAndUnfrozenGraphsAreRejected) {
    std::vector<int> seen;
    Script beyond({0, 1});
    EXPECT_THROW(Serial().run(test::diamond(), &seen, beyond), std::out_of_range);
    Script below({-2});
    EXPECT_THROW(Serial().run(test::diamond(), &seen, below), std::out_of_range);
    Script any({0});
    EXPECT_THROW(Serial().run(TaskGraph(), &seen, any), std::logic_error);
}

TEST(Serial, AllocatesNothingWhileRunning) {
    const TaskGraph graph = test::diamond();
    Script script(std::vector<int>(100, 0));
    std::vector<int> seen;
    seen.reserve(400);
    Serial serial;
    const long before = test::allocation_count();
    serial.run(graph, &seen, script);
    EXPECT_EQ(test::allocation_count(), before);
    EXPECT_EQ(seen.size(), 400u);
}

TEST(AllocationCount, SeesAllocations) {
    const long before = test::allocation_count();
    const std::vector<int> something(1000);
    [[maybe_unused]] const volatile int* volatile seen = something.data();  // or the compiler leaves it out
    if (before < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    EXPECT_GT(test::allocation_count(), before);
    EXPECT_EQ(something.back(), 0);
}

}  // namespace
}  // namespace cvtflow::engine
