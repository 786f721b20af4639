#include "tasks/step/control/step_controller.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "engine/executor/serial.hpp"
#include "engine/method/catalogue.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::tasks {
namespace {

using claims::Rig;

std::vector<double> output_times(Rig& rig, const StepSettings& settings) {
    std::vector<double> times;
    EXPECT_FALSE(rig.run(settings, [&](double t, const Workspace&) { times.push_back(t); }));
    return times;
}

TEST(StepControllerOutputs, ComeExactlyAtMultiplesOfTheIntervalWhateverIsTruncatedBetween) {
    Rig rig(tiny_parameters());
    const double interval = 1e-5;
    const std::vector<double> times = output_times(rig, {settling_begin, settling_begin + 50 * interval, 5e-8, interval});
    EXPECT_GT(rig.counters().truncated, 10);
    ASSERT_EQ(times.size(), 51u);
    for (std::size_t k = 0; k < times.size(); ++k) EXPECT_EQ(times[k], settling_begin + static_cast<double>(k) * interval);
}

TEST(StepControllerOutputs, ComeFirstAndLastAlsoIfTheEndIsNoMultiple) {
    Rig rig(tiny_parameters());
    const std::vector<double> times = output_times(rig, {0.0, 2.52e-6, 1e-7, 1e-6});
    ASSERT_EQ(times.size(), 4u);
    EXPECT_EQ(times[0], 0.0);
    EXPECT_EQ(times[2], 2e-6);
    EXPECT_GE(times[3], 2.52e-6 - 1e-15);  // the first step at or after the end
    EXPECT_LT(times[3], 2.52e-6 + 1e-7);
    const std::vector<double> none = output_times(rig, {times[3], times[3], 1e-7, 1e-6});
    EXPECT_EQ(none, std::vector<double>{times[3]});  // nothing to do: one output, no step
    EXPECT_EQ(rig.counters().steps, 0);
}

TEST(StepControllerOutputs, ShortenTheStepSoThatItDividesTheInterval) {
    Rig rig(tiny_parameters());
    EXPECT_EQ(output_times(rig, {0.0, 1e-5, 3e-8, 1e-6}).size(), 11u);
    EXPECT_EQ(rig.counters().steps - rig.counters().truncated, 10 * 34);                         // 1 µs/30 ns rounded up
    EXPECT_GE(rig.counters().evaluations, 4 * rig.counters().steps + rig.counters().truncated);  // a cut needs the slope at the end
}

TEST(StepControllerOutputs, TakeAThirdThatIsWrittenInThreeDigits) {
    for (const auto& [step, steps] : {std::pair{3.33e-8, 30}, std::pair{3.32e-8, 31}, std::pair{1.11e-7, 9}, std::pair{1.1e-7, 10},
                                      std::pair{5e-10, 2000}, std::pair{9.985e-9, 101}}) {
        Rig rig(tiny_parameters());
        EXPECT_EQ(output_times(rig, {0.0, 2e-6, step, 1e-6}).size(), 3u);
        EXPECT_EQ(rig.counters().steps - rig.counters().truncated, 2 * steps) << step;
    }
}

/// Measures at each transition how far the tip is from its threshold, and how far it moves in a whole step.
class CutWatcher final : public RunObserver {
public:
    explicit CutWatcher(const Workspace& workspace) : w_(workspace) {}
    void output(double, const Workspace&, const Counters&) override {}
    void transition(const TransitionRecord& event) override {
        const model::TipIndicator& at = w_.tips.before[static_cast<std::size_t>(event.tip)];  // at the cut
        const double miss = std::abs(w_.rule.due(event.from, event.to, at));
        const bool by_depth = event.from == model::Phase::free || event.to == model::Phase::free;
        by_depth ? depth_.push_back(miss) : slip_.push_back(miss);
        EXPECT_EQ(event.pin, (event.tip / 4 + event.tip / 2 % 2) % w_.layout().links);
        EXPECT_NE(event.from, event.to);
        EXPECT_GE(event.time, last_);
        last_ = event.time;
    }
    std::vector<double> depth_, slip_;

private:
    const Workspace& w_;
    double last_ = -1e300;
};

TEST(StepControllerTransitions, CutTheStepWhereTheTipReachesItsThreshold) {
    for (const bool stick_slip : {false, true}) {
        model::Parameters p = tiny_parameters();
        p.detail.stick_slip = stick_slip;
        Rig rig(p);
        CutWatcher watcher(rig.workspace());
        const engine::Cancellation never;
        StageMethod method(rig.workspace());
        StepController controller(rig.workspace(), method, {settling_begin, settling_begin + 2e-3, 5e-8, 1e-4}, watcher, never);
        engine::Serial().run(step_graph(rig.workspace(), {}), &rig.workspace(), controller);
        ASSERT_FALSE(controller.fault());
        ASSERT_EQ(static_cast<long>(watcher.depth_.size() + watcher.slip_.size()), controller.counters().detected);
        ASSERT_GT(controller.counters().truncated, 100);
        ASSERT_EQ(watcher.slip_.empty(), !stick_slip);
        // Tips close at some mm/s or faster: 1e-10 m in a step, of which 1e-3 would do. The cut is within 1e-9 of the step and 1e-17 m of
        // rounding (measured 2e-17 m and 3e-12 m/s). Transitions that were suppressed before are farther away by then.
        const auto exact = [](const std::vector<double>& misses, double limit) {
            return std::count_if(misses.begin(), misses.end(), [=](double m) { return m < limit; });
        };
        EXPECT_GE(exact(watcher.depth_, 1e-13), static_cast<long>(watcher.depth_.size()) - controller.counters().suppressed);
        EXPECT_GE(exact(watcher.slip_, 1e-8), static_cast<long>(watcher.slip_.size()) - controller.counters().suppressed);
    }
}

TEST(StepControllerTransitions, PutOffWhileATipHasJustChangedAreMadeUpForAndTheRunContinues) {
    model::Parameters p = tiny_parameters();
    Rig free_running(p);
    ASSERT_FALSE(free_running.run({settling_begin, settling_begin + 1e-4, 5e-8, 1e-5}));
    ASSERT_GT(free_running.counters().detected, 0);
    Rig rig(p);
    std::fill(rig.workspace().tips.changed.begin(), rig.workspace().tips.changed.end(),
              settling_begin + 3e-5);  // as if all had changed at that time
    ASSERT_FALSE(rig.run({settling_begin, settling_begin + 1e-4, 5e-8, 1e-5}));
    EXPECT_GT(rig.counters().suppressed, 0);
    EXPECT_GT(rig.counters().detected, 0);
    for (const auto& event : rig.transitions()) EXPECT_GE(event.time, settling_begin + 3e-5);
    EXPECT_EQ(rig.counters().steps - rig.counters().truncated, 2000);
    EXPECT_EQ(rig.time(), settling_begin + 10 * 1e-5);
}

TEST(StepControllerTransitions, AChatteringChainMakesProgress) {
    model::Parameters p = tiny_parameters();  // undamped and suddenly clamped: everything rattles
    claims::make_conservative(p);
    p.start.settling_time = p.start.ramp_time = 0.0;
    Rig rig(p);
    ASSERT_FALSE(rig.run({0.0, 1e-3, 5e-8, 1e-4}));
    const Counters& c = rig.counters();
    EXPECT_EQ(c.steps - c.truncated, 20000);  // every grid point is reached once
    EXPECT_GT(c.detected, 300);
    EXPECT_LE(c.truncated, c.detected);
    // No tip changes again before its dwell of one and a half steps is over.
    std::map<int, double> last;
    for (const auto& event : rig.transitions()) {
        if (last.contains(event.tip)) {
            EXPECT_GT(event.time - last[event.tip], 0.49 * 5e-8);
        }
        last[event.tip] = event.time;
    }
}

TEST(StepControllerTransitions, EveryCutChangesATipAlsoWhereTheStepIsTakenAgain) {
    // Here a tip is due that has kept its phase long enough by the end of the whole step, but not by the end of the one that is taken
    // again: cut for it without changing it, and cut again, steps of 1e-14 s continued for ever.
    model::Parameters p = tiny_parameters();
    p.detail.stick_slip = true;
    p.start.settling_time = p.start.ramp_time = 5e-5;
    for (const char* method : {"trapezoidal-analytic", "trapezoidal-full", "trapezoidal-frozen", "trapezoidal-schubert"}) {
        SCOPED_TRACE(method);
        Rig rig(p, 1, method);
        StepSettings settings{-5e-5, 0.0, 1e-5 / 7, 1e-5};
        settings.max_steps = 3000;
        ASSERT_FALSE(rig.run(settings));
        const Counters& c = rig.counters();
        EXPECT_EQ(c.steps - c.truncated, 35);
        EXPECT_GT(c.truncated, 10);
        EXPECT_LE(c.truncated, c.detected);
        EXPECT_EQ(c.detected, static_cast<long>(rig.transitions().size()));
    }
}

/// Runs with settings that a Rig does not offer.
Fault run_with(Rig& rig, const StepSettings& settings, RunObserver& observer, const engine::Cancellation& cancel,
               Counters* counters = nullptr) {
    StageMethod method(rig.workspace());
    StepController controller(rig.workspace(), method, settings, observer, cancel);
    engine::Serial().run(step_graph(rig.workspace(), {}), &rig.workspace(), controller);
    if (counters != nullptr) *counters = controller.counters();
    controller.rethrow();
    return controller.fault();
}

/// The state that a run of that many whole steps leaves.
void expect_good_state(Rig& rig) {
    for (int k = 0; k < rig.variator().layout().size(); ++k) ASSERT_TRUE(std::isfinite(rig.state()[k]));
    const double from = rig.time();
    EXPECT_FALSE(rig.run({from, from + 1e-6, 5e-8, 1e-6})) << "it can continue";
}

TEST(StepControllerBudgets, StepsAreCountedAndTheStateIsLeftGood) {
    Rig rig(tiny_parameters());
    SilentObserver silent;
    const engine::Cancellation never;
    Counters counters;
    const Fault fault = run_with(rig, {settling_begin, 0.0, 5e-8, 1e-5, 137}, silent, never, &counters);
    EXPECT_EQ(fault.kind, FaultKind::max_steps);
    EXPECT_EQ(fault.limit, 137.0);
    EXPECT_EQ(fault.time, rig.time());
    EXPECT_EQ(counters.steps, 137);
    expect_good_state(rig);
}

TEST(StepControllerBudgets, WallTimeEndsTheRunAndTheStateIsLeftGood) {
    Rig rig(tiny_parameters());
    SilentObserver silent;
    const engine::Cancellation never;
    const Fault fault = run_with(rig, {settling_begin, 10.0, 5e-8, 1e-5, 0, 0.02}, silent, never);
    EXPECT_EQ(fault.kind, FaultKind::max_wall);
    EXPECT_GE(fault.value, 0.02);
    EXPECT_LT(fault.time, 0.0);
    expect_good_state(rig);
}

class Canceller final : public RunObserver {
public:
    explicit Canceller(engine::Cancellation& cancel) : cancel_(cancel) {}
    void output(double time, const Workspace&, const Counters&) override {
        if (time >= settling_begin + 3e-6) cancel_.request();
    }
    void transition(const TransitionRecord&) override {}

private:
    engine::Cancellation& cancel_;
};

TEST(StepControllerBudgets, CancellingEndsTheRunBeforeTheNextStep) {
    Rig rig(tiny_parameters());
    engine::Cancellation cancel;
    Canceller canceller(cancel);
    const Fault fault = run_with(rig, {settling_begin, 0.0, 5e-8, 1e-6}, canceller, cancel);
    EXPECT_EQ(fault.kind, FaultKind::cancelled);
    EXPECT_EQ(fault.time, settling_begin + 3 * 1e-6);
    expect_good_state(rig);
}

class Thrower final : public RunObserver {
public:
    explicit Thrower(bool at_transition) : at_transition_(at_transition) {}
    void output(double time, const Workspace&, const Counters&) override {
        if (!at_transition_ && time > settling_begin) throw std::runtime_error("disk full");
    }
    void transition(const TransitionRecord&) override {
        if (at_transition_) throw std::runtime_error("disk full");
    }

private:
    bool at_transition_;
};

TEST(StepControllerObserver, WhatItThrowsEndsTheRunAndComesOut) {
    for (const bool at_transition : {false, true}) {
        Rig rig(tiny_parameters());
        Thrower thrower(at_transition);
        const engine::Cancellation never;
        try {
            static_cast<void>(run_with(rig, {settling_begin, 0.0, 5e-8, 1e-5}, thrower, never));
            FAIL() << "nothing came out";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "disk full");
        }
        EXPECT_LT(rig.time(), settling_begin + 1e-3);
        expect_good_state(rig);
    }
}

}  // namespace
}  // namespace cvtflow::tasks
