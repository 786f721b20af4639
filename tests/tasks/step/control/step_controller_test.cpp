#include "tasks/step/control/step_controller.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "engine/executor/serial.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/step/control/energy_ledger.hpp"
#include "tasks/step/control/step_control.hpp"
#include "tasks/step/control/step_grid.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

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

/// Shortly after a start samples lie closer than outputs and miss some of them.
TEST(StepControllerOutputs, ReadTheEvaluationOfALossSampleWithTheBitsOfTheirOwn) {
    Rig rig(tiny_parameters());
    int shared = 0, outputs = 0;
    const auto compare = [&](double t, const Workspace& w) {
        ++outputs;
        if (!w.links.observed) return;
        ++shared;
        model::Observer reading(w.variator), evaluating(w.variator);
        const model::Observation& read = w.observed_by(reading, t);
        const model::Observation& evaluated = evaluating.observe(t, w.state(), w.tips.phases.data());
        EXPECT_GT(evaluated.touching, 0);
        EXPECT_GT(evaluated.account[model::Energy::kinetic], 0.0);
        EXPECT_EQ(read.account.loss, evaluated.account.loss);
        EXPECT_EQ(read.account.energy, evaluated.account.energy);
        EXPECT_EQ(read.tension, evaluated.tension);
        EXPECT_EQ(read.tip_axial, evaluated.tip_axial);
        EXPECT_EQ(read.axial_force, evaluated.axial_force);
        EXPECT_EQ(read.chain_torque, evaluated.chain_torque);
        EXPECT_EQ(read.deepest, evaluated.deepest);
        EXPECT_EQ(read.friction_slip, evaluated.friction_slip);
        EXPECT_EQ(reading.forces().chain.tip_radial, evaluating.forces().chain.tip_radial);
    };
    ASSERT_FALSE(rig.run({0.0, 2e-5, 5e-8, 1e-6}, compare));
    EXPECT_EQ(outputs, 21);
    EXPECT_GE(shared, 3);
}

/// Rounded up: 1 µs/30 ns is 34; a third that is written in three digits is a third.
TEST(StepControllerOutputs, ShortenTheStepSoThatItDividesTheInterval) {
    for (const auto& [step, steps] : {std::pair{3e-8, 34}, std::pair{3.33e-8, 30}, std::pair{3.32e-8, 31}, std::pair{1.11e-7, 9},
                                      std::pair{1.1e-7, 10}, std::pair{5e-10, 2000}, std::pair{9.985e-9, 101}}) {
        Rig rig(tiny_parameters());
        EXPECT_EQ(output_times(rig, {0.0, 2e-6, step, 1e-6}).size(), 3u);
        EXPECT_EQ(rig.counters().steps - rig.counters().truncated, 2 * steps) << step;
        EXPECT_GE(rig.counters().evaluations, 4 * rig.counters().steps + rig.counters().truncated);  // a cut needs the slope at the end
    }
}

/// Measures at each transition how far the tip is from its threshold.
TEST(StepControllerTransitions, CutTheStepWhereTheTipReachesItsThreshold) {
    for (const bool stick_slip : {false, true}) {
        model::Parameters p = tiny_parameters();
        p.detail.stick_slip = stick_slip;
        Rig rig(p);
        const Workspace& w = rig.workspace();
        std::vector<double> depths, slips;
        double last = -1e300;
        Outputs watcher({}, [&](const TransitionRecord& event) {
            const model::TipIndicator& at = w.tips.before[static_cast<std::size_t>(event.tip)];  // at the cut
            const double miss = std::abs(w.rule.due(event.from, event.to, at));
            const bool by_depth = event.from == model::Phase::free || event.to == model::Phase::free;
            (by_depth ? depths : slips).push_back(miss);
            EXPECT_EQ(event.pin, (event.tip / 4 + event.tip / 2 % 2) % w.layout().links);
            EXPECT_NE(event.from, event.to);
            EXPECT_GE(event.time, last);
            last = event.time;
        });
        const engine::Cancellation never;
        StageMethod method(rig.workspace());
        StepController controller(rig.workspace(), method, {settling_begin, settling_begin + 2e-3, 5e-8, 1e-4}, watcher, never);
        engine::Serial().run(step_graph(rig.workspace(), {}), &rig.workspace(), controller);
        ASSERT_FALSE(controller.fault());
        ASSERT_EQ(static_cast<long>(depths.size() + slips.size()), controller.counters().detected);
        ASSERT_GT(controller.counters().truncated, 100);
        ASSERT_EQ(slips.empty(), !stick_slip);
        // Tips close at some mm/s or faster: 1e-10 m in a step, of which 1e-3 would do. The cut is within 1e-9 of the step and 1e-17 m of
        // rounding (measured 2e-17 m and 3e-12 m/s). Transitions that were suppressed before are farther away by then.
        const auto exact = [](const std::vector<double>& misses, double limit) {
            return std::count_if(misses.begin(), misses.end(), [=](double m) { return m < limit; });
        };
        EXPECT_GE(exact(depths, 1e-13), static_cast<long>(depths.size()) - controller.counters().suppressed);
        EXPECT_GE(exact(slips, 1e-8), static_cast<long>(slips.size()) - controller.counters().suppressed);
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
    ASSERT_FALSE(rig.run({0.0, 1.25e-3, 5e-8, 1.25e-4}));
    const Counters& c = rig.counters();
    EXPECT_EQ(c.steps - c.truncated, 25000);  // every grid point is reached once
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

TEST(StepControllerBudgets, EndTheRunAndLeaveTheStateGood) {
    SilentObserver silent;
    const engine::Cancellation never;
    for (const auto& [steps, wall] : {std::pair{137L, 0.0}, {0L, 0.02}}) {
        Rig rig(tiny_parameters());
        Counters counters;
        const Fault fault = run_with(rig, {settling_begin, 10.0, 5e-8, 1e-5, steps, wall}, silent, never, &counters);
        EXPECT_EQ(fault.kind, steps > 0 ? FaultKind::max_steps : FaultKind::max_wall);
        EXPECT_EQ(fault.time, rig.time());
        if (steps > 0) {
            EXPECT_EQ(counters.steps, steps);
            EXPECT_EQ(fault.limit, 137.0);
        } else {
            EXPECT_GE(fault.value, wall);
            EXPECT_LT(fault.time, 0.0);
        }
        expect_good_state(rig);
    }
}

TEST(StepControllerBudgets, CancellingEndsTheRunBeforeTheNextStep) {
    Rig rig(tiny_parameters());
    engine::Cancellation cancel;
    Outputs canceller([&](double time, const Workspace&, const Counters&) {
        if (time >= settling_begin + 3e-6) cancel.request();
    });
    const Fault fault = run_with(rig, {settling_begin, 0.0, 5e-8, 1e-6}, canceller, cancel);
    EXPECT_EQ(fault.kind, FaultKind::cancelled);
    EXPECT_EQ(fault.time, settling_begin + 3 * 1e-6);
    expect_good_state(rig);
}

TEST(StepControllerObserver, WhatItThrowsEndsTheRunAndComesOut) {
    for (const bool at_transition : {false, true}) {
        Rig rig(tiny_parameters());
        const auto fail = [](bool now) {
            if (now) throw std::runtime_error("disk full");
        };
        Outputs thrower([&](double time, const Workspace&, const Counters&) { fail(!at_transition && time > settling_begin); },
                        [&](const TransitionRecord&) { fail(at_transition); });
        const engine::Cancellation never;
        EXPECT_EQ(message_of<std::runtime_error>([&] {
                      return run_with(rig, {settling_begin, 0.0, 5e-8, 1e-5}, thrower, never);
                  }),
                  "disk full");
        EXPECT_LT(rig.time(), settling_begin + 1e-3);
        expect_good_state(rig);
    }
}

/// Losses of 20 W, and a residual that swings by 0.1 mJ as pins strike the sheave every 7 ms: 0.4 % of the losses of 2 ms, 0 of a pin
/// period. 0.1 W that are missing for 50 ms are found, and named.
TEST(EnergyLedger, JudgesSlowChainsByThePeriodOfAPin) {
    const auto judged = [](double defect) {
        EnergyLedger ledger;
        ledger.restart(1);
        EnergyAccount& account = ledger.count();
        for (int k = 0; k <= 5000; ++k) {
            const double time = 1e-4 * k;
            account.lost[0] = account.work[0] = 20.0 * time;
            account.stored = 1e-4 * std::sin(2.0 * std::numbers::pi * time / 7e-3) + defect * std::clamp(time - 0.1, 0.0, 0.05);
            ledger.sample_counted(time, 7e-3);
        }
        return ledger.judged();
    };
    EXPECT_LT(judged(0.0).ratio, 0.5);
    const JudgedBalance found = judged(0.1);
    EXPECT_GT(found.ratio, 1.0);
    EXPECT_NEAR(found.relative, 0.1 / 20.0, 1e-4);
    EXPECT_NEAR(found.end - found.begin, 7e-3, 2e-4);
    EXPECT_TRUE(found.begin > 0.09 && found.end < 0.16) << found.begin;
}

TEST(ErrorScale, MeasuresCoordinatesInMicrometresAndVelocitiesInSaturationSpeeds) {
    const ErrorScale scale{1e-6, 2e-3};
    const std::array<double, 4> errors{3e-6, 0.0, 0.0, 8e-3};  // q, q, v, v
    EXPECT_DOUBLE_EQ(scale.norm(errors.data(), 2), std::sqrt((9.0 + 16.0) / 4.0));
}

/// Steps that are shortened for an output do not shorten the next.
TEST(StepSizeControl, BeginsWithTheLongestStepAndNeverExceedsIt) {
    for (const double taken : {1e-6, 1e-9}) {
        StepSizeControl control(1e-6, 3);
        EXPECT_EQ(control.proposal(), 1e-6);
        EXPECT_TRUE(control.judge(1e-9, taken));
        EXPECT_EQ(control.proposal(), 1e-6);
    }
}

TEST(StepSizeControl, RejectsTooLargeErrorsAndWhatIsNoNumber) {
    for (const double error : {1.0001, 1e30, std::numeric_limits<double>::infinity(), std::nan("")}) {
        StepSizeControl control(1e-6, 3);
        EXPECT_FALSE(control.judge(error, 1e-6)) << error;
        EXPECT_LT(control.proposal(), 0.91e-6) << error;
        EXPECT_GE(control.proposal(), 0.99e-7) << error;
    }
}

/// error = (step/h1)^power: the steps settle where the error is a little below 1, whatever they begin with.
TEST(StepSizeControl, FindsTheStepThatTheToleranceAllows) {
    for (const int power : {2, 3, 5, 8}) {
        StepSizeControl control(1e-3, power);
        double step = control.proposal();
        for (int i = 0; i < 100; ++i) {
            (void)control.judge(std::pow(step / 1e-6, power), step);
            step = control.proposal();
        }
        EXPECT_LT(step, 1e-6) << power;
        EXPECT_GT(step, 0.5e-6) << power;
    }
}

TEST(StepSizeControl, DoesNotGrowRightAfterARejection) {
    StepSizeControl control(1e-6, 3);
    EXPECT_FALSE(control.judge(8.0, 1e-6));
    const double shorter = control.proposal();
    EXPECT_TRUE(control.judge(1e-3, shorter));
    EXPECT_LE(control.proposal(), shorter);
    EXPECT_TRUE(control.judge(1e-3, shorter));
    EXPECT_GT(control.proposal(), shorter);
}

constexpr double point = 1e-3;  // [s]

/// First point after 0 in any mode of drive, load, hydraulics and control. scene [with the table]
[[nodiscard]] double first_point_in_some_mode(Scene scene) {
    model::Parameters& p = scene.parameters;
    double first = 1.0;
    for (int mode = 0; mode < 36; ++mode) {
        p.drive.mode = mode % 2 == 0 ? model::DriveMode::torque : model::DriveMode::speed;
        p.load.mode = mode / 2 % 3 == 0 ? model::LoadMode::torque : mode / 2 % 3 == 1 ? model::LoadMode::speed : model::LoadMode::coupling;
        p.hydraulics.mode = static_cast<model::HydraulicMode>(mode / 6 % 3);
        p.control.enabled = mode / 18 == 1;
        first = std::min(first, next_input_point(p, model::HeldInputs{}, 0.0));
    }
    return first;
}

TEST(InputPoints, OfEveryTableOverTimeAreSeen) {
    int tables = 0;
    for (const Parameter& parameter : parameter_table()) {
        if (parameter.kind() != Kind::time_table) continue;
        if (parameter.section() == "vehicle" || parameter.section() == "cycle") continue;  // other tables follow from them
        ++tables;
        Scene scene = ready_tiny();
        ASSERT_EQ(first_point_in_some_mode(scene), 1.0) << "tiny has constant inputs";
        model::TimeTable& table = *std::get<model::TimeTable*>(parameter.member(scene));
        table.time = {0.0, point};
        table.value = {1.0, 2.0};
        EXPECT_EQ(first_point_in_some_mode(scene), point) << parameter.key;
    }
    EXPECT_GE(tables, 10);
}

/// Samples of a chain that dissipates `power` [W] and whose energy changes at `rate` [W], for 4 ms.
EnergyLedger sampled(double power, double rate) {
    EnergyLedger ledger;
    ledger.restart(1);
    for (int k = 0; k <= 400; ++k) {
        model::Account links;
        links.lose(model::Loss::tip_friction, power);
        links.store(model::Energy::plates, 1.0 + rate * 1e-5 * k);
        ledger.sample(1e-5 * k, links, {}, 7e-4);
    }
    return ledger;
}

/// Or a hundredth of what is lost comes from nowhere: ten times the tolerance.
TEST(EnergyLedger, ClosesWhereWhatIsLostWasStoredAndCallsTheRestUnreliable) {
    const EnergyLedger honest = sampled(300.0, -300.0), wrong = sampled(300.0, -297.0);
    EXPECT_NEAR(honest.balance().loss, 300.0 * 4e-3, 1e-12);
    EXPECT_NEAR(honest.balance().residual(), 0.0, 1e-12);
    EXPECT_LE(honest.balance_error_ratio(), 1.0);
    EXPECT_NEAR(wrong.balance().relative(), 0.01, 1e-9);
    EXPECT_GT(wrong.balance_error_ratio(), 5.0);
}

/// Samples 12 steps apart, outputs 50: one where an output is, none shortly before.
TEST(EnergyLedger, SamplesLossesAtOutputsThatAreNear) {
    EnergyLedger ledger;
    const model::Variator ring(tiny_parameters());
    ledger.restart(12);
    std::vector<int> sampled;
    const std::vector<double> tail(static_cast<std::size_t>(ring.layout().size() - ring.layout().pulley_begin()));
    constexpr double begin = 1.0, step = 2e-6;  // long after the start, where samples are closer
    for (int k = 0; k <= 100; ++k) {
        const double time = k == 0 ? 0.0 : begin + k * step;
        if (k > 0) ledger.step(ring, time - step, tail.data(), time, tail.data());
        if (!ledger.due(time, (50 - k % 50) % 50)) continue;
        ledger.sample(time, {}, {}, 1e-3);
        sampled.push_back(k);
    }
    EXPECT_EQ(sampled, (std::vector<int>{0, 12, 24, 36, 50, 62, 74, 86, 100}));
}

TEST(EnergyLedger, ContinuesFromItsFields) {
    EnergyLedger before = sampled(300.0, -297.0), after;
    std::vector<std::byte> fields;
    engine::write_fields(fields, [&](auto& archive) { before.visit(archive); });
    after.restart(1);
    engine::read_fields(fields, [&](auto& archive) { after.visit(archive); });
    EXPECT_EQ(after.balance().loss, before.balance().loss);
    EXPECT_EQ(after.balance_error_ratio(), before.balance_error_ratio());
}

/// Powers that grow and turn over from sample to sample, as where a step is too long for damping: as much noise as power, and nothing
/// was stored.
TEST(EnergyLedger, NoiseThatARunMakesByItselfExcusesNothing) {
    EnergyLedger ledger;
    ledger.restart(1);
    for (int k = 0; k <= 40; ++k) {
        model::Account links;
        links.lose(model::Loss::tip_friction, k % 2 == 0 ? std::ldexp(1e-6, k) : 0.0);
        links.store(model::Energy::plates, 1.0);
        ledger.sample(1e-5 * k, links, {}, 7e-4);
    }
    EXPECT_GT(6.0 * ledger.balance().deviation, ledger.balance().loss) << "noise alone would explain it";
    EXPECT_NEAR(ledger.balance().relative(), 1.0, 1e-12);
    EXPECT_GT(ledger.balance_error_ratio(), 1.0);
}

/// A start that does not fit: what it dissipates at once is as noisy as it is large.
TEST(EnergyLedger, NoiseExcusesNoMoreThanAHundredthOfTheLossesWhereThereAreInputs) {
    EnergyBalance balance{.span = 20e-3, .change = -100.0, .loss = 101.1, .stored = 100.0, .deviation = 50.0, .samples = 500.0};
    EXPECT_LT(balance.balance_error_ratio(), 1.0) << "a ring: nothing comes in";
    balance.energy_in = 600.0;
    EXPECT_GT(balance.balance_error_ratio(), 1.0);
    balance.loss = 100.6;  // no right run exceeded 0.0063
    EXPECT_LT(balance.balance_error_ratio(), 1.0);
}

TEST(EnergyFlow, HasAnEfficiencyWhereEnergyFlows) {
    EnergySums before, after;
    after.loss[0] = 2.0;
    after.work = {100.0, -98.0, 0.0};  // drive brings, load takes
    EXPECT_DOUBLE_EQ(after.since(before).efficiency(), 0.98);
    EXPECT_TRUE(std::isnan(before.since(before).efficiency())) << "without input there is none";
    after.drag = {1.0, 2.0};  // of 101 J the load gets 96
    EXPECT_DOUBLE_EQ(after.outside_since(before).efficiency(), 1.0 - 5.0 / 101.0);
    EXPECT_DOUBLE_EQ(after.since(before).with_pump(20.0, 8.0).efficiency(), 1.0 - 10.0 / 120.0);
    EXPECT_DOUBLE_EQ(after.since(before).with_pump(0.0, 8.0).efficiency(), 0.98) << "there is no pump";
    after.work = {100.0, -0.9, 0.0};
    EXPECT_TRUE(std::isnan(after.since(before).efficiency())) << "shafts take less than a hundredth";
    after.work = {1.9, -1.0, 0.0};
    EXPECT_TRUE(std::isnan(after.since(before).efficiency())) << "of 1.9 J 2 are lost: -5 %";
}

}  // namespace
}  // namespace cvtflow::tasks
