/// The chooser on invented machines: time is computed, not measured.

#include "tasks/schedule/schedule_chooser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "tests/engine/allocation_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Time per cycle of a candidate at a time [s].
using Machine = std::function<double(int candidate, double time)>;

/// Time of a run, and its time with the first candidate only [s].
struct Invented {
    double seconds = 0.0, serial = 0.0;
};

Invented run(ScheduleChooser& chooser, const Machine& machine, double seconds) {
    Invented outcome;
    while (outcome.seconds < seconds) {
        const double cost = machine(chooser.candidate(), outcome.seconds), serial = machine(0, outcome.seconds);
        const double cycles = std::max(1.0, std::ceil(chooser.window() / cost));
        outcome.seconds += cycles * cost;
        outcome.serial += cycles * serial;
        chooser.record({cycles * cost, cost});
    }
    return outcome;
}

constexpr double serial_cost = 25e-6;

/// Candidates of 1, 2, 4, 8 and 16 threads, with the gain of each.
Machine gains(const std::array<double, 5>& of) {
    return [=](int candidate, double) { return serial_cost / of[static_cast<std::size_t>(candidate)]; };
}

TEST(ScheduleChooser, TakesWhatIsFaster) {
    ScheduleChooser chooser(3, {});
    const Invented outcome = run(
        chooser, [](int candidate, double) { return serial_cost / (1.0 + 0.4 * candidate); }, 10.0);
    EXPECT_EQ(chooser.chosen(), 2);
    EXPECT_EQ(chooser.changes(), 1);
    EXPECT_GT(outcome.serial / outcome.seconds, 0.98 * 1.8);
    EXPECT_DOUBLE_EQ(chooser.per_cycle(1), serial_cost / 1.4);
}

TEST(ScheduleChooser, UsesNoMoreThreadsThanPay) {
    for (const auto& [of, best] :
         {std::pair{std::array{1.0, 1.6, 2.2, 3.0, 4.0}, 4}, {{1.0, 1.50, 1.65, 1.66, 1.60}, 2}, {{1.0, 1.04, 1.03, 0.9, 0.5}, 0}}) {
        ScheduleChooser chooser(5, {});
        run(chooser, gains(of), 10.0);
        EXPECT_EQ(chooser.chosen(), best);
    }
}

TEST(ScheduleChooser, CostsFivePercentOfSerialAtMostHoweverBadTheOtherIs) {
    for (const double factor : {1.01, 1.2, 2.0, 6.0, 100.0}) {
        for (const double seconds : {0.5, 1.0, 3.0, 60.0}) {
            ScheduleChooser chooser(2, {});
            const Invented outcome = run(
                chooser, [=](int candidate, double) { return candidate == 0 ? serial_cost : factor * serial_cost; }, seconds);
            EXPECT_EQ(chooser.chosen(), 0);
            EXPECT_LT(outcome.seconds, 1.05 * outcome.serial) << factor << " " << seconds;
        }
    }
}

TEST(ScheduleChooser, LeavesAScheduleThatALoadHasMadeSlowAndComesBack) {
    ScheduleChooser chooser(2, {});
    const auto loaded = [](int candidate, double) { return candidate == 0 ? serial_cost : 2.0 * serial_cost; };
    const auto free = [](int candidate, double) { return candidate == 0 ? serial_cost : serial_cost / 1.9; };
    run(chooser, free, 5.0);
    EXPECT_EQ(chooser.chosen(), 1);
    const Invented under_load = run(chooser, loaded, 0.2);
    EXPECT_EQ(chooser.chosen(), 0) << "within 0.2 s";
    EXPECT_LT(under_load.seconds, 2.0 * under_load.serial);
    run(chooser, free, 1.2);  // serial's pace says nothing
    EXPECT_EQ(chooser.chosen(), 1) << "a second later";
}

TEST(ScheduleChooser, OfOneCandidateNeverChangesAnything) {
    ScheduleChooser chooser(1, {});
    run(
        chooser, [](int, double time) { return (1.0 + time) * serial_cost; }, 5.0);
    EXPECT_EQ(chooser.checks(), 0);
    EXPECT_EQ(chooser.candidate(), 0);
}

TEST(ScheduleChooser, AllocatesNothingOnTheWay) {
    if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    ScheduleChooser chooser(4, {});
    const Machine machine = [](int candidate, double time) { return serial_cost * (1.0 + 0.5 * std::sin(time * (1 + candidate))); };
    const long before = engine::test::allocation_count();
    run(chooser, machine, 20.0);
    EXPECT_EQ(engine::test::allocation_count(), before);
    EXPECT_GT(chooser.checks(), 1);
}

}  // namespace
}  // namespace cvtflow::tasks
