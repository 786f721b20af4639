#include "engine/thread/floating_mode.hpp"

#include <gtest/gtest.h>

#include <cfenv>
#include <vector>

#include "tests/engine/executor/executor_fixture.hpp"

namespace cvtflow::engine {
namespace {

/// A third, as the thread rounds it that runs the task.
double third() noexcept {
    const volatile double one = 1.0, three = 3.0;
    return one / three;
}

void divide(void* context, int item) noexcept { (*static_cast<std::vector<double>*>(context))[static_cast<std::size_t>(item)] = third(); }

struct Times final : Controller {
    explicit Times(int count) : left(count) {}
    int next() noexcept override { return left-- > 0 ? 0 : stop; }
    int left;
};

TEST(Rounding, IsTheCallersOnEveryThread) {
    test::for_each(test::all_cases(), [&](const test::Case& each) {
        TaskGraph graph;
        for (int task = 0; task < 8; ++task) graph.add({"t", 0, divide, task, {}});
        graph.freeze();
        const auto executor = each.make();
        for (const int mode : {FE_TONEAREST, FE_DOWNWARD, FE_UPWARD}) {
            std::fesetround(mode);
            const double expected = third();
            std::vector<double> seen(8, 0.0);
            Times hundred(100);
            executor->run(graph, &seen, hundred);
            EXPECT_EQ(seen, std::vector<double>(8, expected));
            EXPECT_EQ(std::fegetround(), mode);
        }
        std::fesetround(FE_TONEAREST);
    });
}

TEST(FloatingScope, GivesTheThreadItsOwnModeBack) {
    const double nearest = third();
    std::fesetround(FE_UPWARD);
    const FloatingMode upward;
    const double more = third();
    std::fesetround(FE_TONEAREST);
    {
        const FloatingScope scope(upward);
        EXPECT_EQ(third(), more);
    }
    EXPECT_EQ(third(), nearest);
    EXPECT_NE(more, nearest);
}

}  // namespace
}  // namespace cvtflow::engine
