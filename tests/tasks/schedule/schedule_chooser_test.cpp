/// The chooser on invented machines: time is computed, not measured.

#include "tasks/schedule/schedule_chooser.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/engine/allocation_fixture.hpp"

namespace cvtflow::tasks {
namespace {

/// Time per cycle of a candidate at a time [s].
using Machine = std::function<double(int candidate, double time)>;

/// Time of a run of a number of cycles, and its time with the first candidate only.
struct Invented {
    double seconds = 0.0, serial = 0.0;
    long decisions_late = 0;  ///< windows in which the chosen candidate was not the fastest
};

/// Threads meet fast where `near`; to find out takes 0.1 ms.
Invented run(
    ScheduleChooser& chooser, const Machine& machine, double seconds,
    const std::function<int(double)>& touching = [](double) { return 30; }, bool near = false) {
    Invented outcome;
    while (outcome.seconds < seconds) {
        const double cost = machine(chooser.candidate(), outcome.seconds), serial = machine(0, outcome.seconds);
        const double cycles = std::max(1.0, std::ceil(chooser.window() / cost));
        outcome.seconds += cycles * cost;
        outcome.serial += cycles * serial;
        chooser.record({cycles * cost, cost, touching(outcome.seconds)});
        if (chooser.asks() == 0) continue;
        chooser.answer(near ? 0.1e-6 : 0.5e-6, 1e-4);
        outcome.seconds += 1e-4;
    }
    return outcome;
}

constexpr double serial_cost = 25e-6;

/// One thread, then two for each of the others.
template <int candidates>
constexpr auto equal_threads = [] {
    std::array<int, candidates> threads{};
    threads.fill(2);
    threads[0] = 1;
    return threads;
}();

/// Candidates of 1, 16, 8, 4 and 2 threads, with the gain of each.
constexpr std::array many_threads{1, 16, 8, 4, 2};
Machine gains(const std::array<double, 5>& of) {
    return [=](int candidate, double) { return serial_cost / of[static_cast<std::size_t>(candidate)]; };
}

TEST(ScheduleChooser, TakesWhatIsFaster) {
    ScheduleChooser chooser(equal_threads<3>, {});
    const Invented outcome = run(
        chooser, [](int candidate, double) { return serial_cost / (1.0 + 0.4 * candidate); }, 10.0);
    EXPECT_EQ(chooser.chosen(), 2);
    EXPECT_EQ(chooser.changes(), 1);
    EXPECT_GT(outcome.serial / outcome.seconds, 0.93 * 1.8);  // half a second passes before the first trial may cost anything
    EXPECT_DOUBLE_EQ(chooser.per_cycle(1), serial_cost / 1.4);
}

TEST(ScheduleChooser, UsesNoMoreThreadsThanPayAndGivesBackThoseThatNoLongerDo) {
    ScheduleChooser chooser(many_threads, {});
    const auto chosen = [&] { return many_threads[static_cast<std::size_t>(chooser.chosen())]; };
    run(chooser, gains({1.0, 4.0, 3.0, 2.2, 1.6}), 10.0);
    ASSERT_EQ(chosen(), 16);
    run(chooser, gains({1.0, 1.60, 1.66, 1.65, 1.50}), 10.0);
    EXPECT_EQ(chosen(), 4) << "0.6 % slower than eight threads";
    ScheduleChooser other(many_threads, {});
    run(other, gains({1.0, 1.60, 1.66, 1.62, 1.30}), 10.0);
    EXPECT_EQ(many_threads[static_cast<std::size_t>(other.chosen())], 4) << "2.4 % slower than eight threads";
}

TEST(ScheduleChooser, AsksWithinItsShareOfTheTime) {
    ScheduleChooser chooser(many_threads, {});
    double time = 0.0, asked = 0.0;
    constexpr double question = 0.009;  // beside busy neighbours [s]
    while (chooser.checks() == 0 && time < 5.0) {
        time += chooser.window();
        chooser.record({chooser.window(), serial_cost, 30});
        if (chooser.asks() == 0) continue;
        EXPECT_EQ(chooser.asks(), 2);
        chooser.answer(std::numeric_limits<double>::infinity(), question);
        time += question;
        asked += question;
    }
    EXPECT_GT(chooser.checks(), 0);
    EXPECT_LE(asked, 0.5 * ChooserOptions{}.max_trial_share * time + question);
}

TEST(ScheduleChooser, NeverCostsTwoPercentOfSerialHoweverBadTheOthersAre) {
    for (const double factor : {1.01, 1.2, 2.0, 6.0, 100.0}) {
        for (const double seconds : {0.01, 0.3, 0.6, 1.0, 3.0, 60.0}) {
            ScheduleChooser chooser(equal_threads<4>, {});  // whose threads are far: near ones may lose a turn more
            const Invented outcome = run(
                chooser, [=](int candidate, double) { return candidate == 0 ? serial_cost : factor * serial_cost; }, seconds);
            EXPECT_EQ(chooser.chosen(), 0);
            EXPECT_LT(outcome.seconds, 1.02 * outcome.serial) << factor << " " << seconds;
        }
    }
}

TEST(ScheduleChooser, LeavesAScheduleThatALoadHasMadeSlow) {
    ScheduleChooser chooser(equal_threads<2>, {});
    const Machine machine = [](int candidate, double time) {
        return candidate == 0 ? serial_cost : time < 5.0 || time > 10.0 ? serial_cost / 1.9 : 2.0 * serial_cost;
    };
    const Invented before = run(chooser, machine, 5.0);
    EXPECT_EQ(chooser.chosen(), 1);
    const double then = before.seconds;
    const Invented under_load = run(
        chooser, [&](int candidate, double time) { return machine(candidate, time + then); }, 0.4);  // 0.1 s to see it, and a check
    EXPECT_EQ(chooser.chosen(), 0) << "within 0.4 s";
    EXPECT_LT(under_load.seconds, 2.0 * under_load.serial);
}

TEST(ScheduleChooser, OfOneCandidateNeverChangesAnything) {
    ScheduleChooser chooser(equal_threads<1>, {});
    run(
        chooser, [](int, double time) { return (1.0 + time) * serial_cost; }, 5.0);
    EXPECT_EQ(chooser.checks(), 0);
    EXPECT_EQ(chooser.candidate(), 0);
}

TEST(ScheduleChooser, AllocatesNothingOnTheWay) {
    if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    ScheduleChooser chooser(equal_threads<4>, {});
    const Machine machine = [](int candidate, double time) { return serial_cost * (1.0 + 0.5 * std::sin(time * (1 + candidate))); };
    const std::function<int(double)> touching = [](double) { return 30; };
    const long before = engine::test::allocation_count();
    run(chooser, machine, 20.0, touching);
    EXPECT_EQ(engine::test::allocation_count(), before);
    EXPECT_GT(chooser.checks(), 1);
}

}  // namespace
}  // namespace cvtflow::tasks
