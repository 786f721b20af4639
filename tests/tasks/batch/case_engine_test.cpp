#include "tasks/batch/case_engine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "tasks/batch/start_states.hpp"
#include "tasks/run/run.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/tasks/tiny_fixture.hpp"
#include "tests/temporary_file_fixture.hpp"

namespace cvtflow::tasks {
namespace {

class CaseOfAWorker : public testing::Test {
protected:
    /// Eight cases of tiny.
    [[nodiscard]] Sweep sweep(const std::string& mode, const std::string& more = "") const {
        std::ofstream(folder_ / "s.toml")
            << "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nstart.settling_time = \"20 us\"\nstart.ramp_time = \"10 us\"\n"
               "[[axes]]\nkey = \"load.torque\"\nvalues = [\"6 N*m\", \"12 N*m\"]\n[[axes]]\nkey = \"clamping.driven\"\nfrom = \"5 kN\"\n"
               "to = \"6 kN\"\ncount = 4\n[outputs]\nscalars = [\"slip mean\", \"tight_tension max\"]\n[start]\nmode = \""
            << mode << "\"\n"
            << more;
        return written();
    }
    /// The sweep that a test has written.
    [[nodiscard]] Sweep written() const { return read_sweep(folder_ / "s.toml", scene_file); }
    /// One engine and its data.
    struct Worker {
        Worker(const Sweep& sweep, const std::filesystem::path& folder)
            : starts(sweep, folder / "states"), engine(sweep, starts, control, {folder / "records", folder / "continuation"}) {}
        StartStates starts;
        engine::Cancellation never;
        BatchControl control{1.0, never};
        CaseEngine engine;
    };
    /// Allocations of each case, one after the other on one engine.
    [[nodiscard]] std::vector<long> allocations(const Sweep& sweep) const {
        Worker worker(sweep, folder_);
        std::vector<long> counts;
        for (long number = 0; number < sweep.cases(); ++number) {
            const long before = engine::test::allocation_count();
            EXPECT_EQ(worker.engine.run(number).status, CaseStatus::ok);
            counts.push_back(engine::test::allocation_count() - before);
        }
        return counts;
    }

    const tests::TemporaryFolder place_{"case"};
    const std::filesystem::path folder_ = place_ / "";
};

/// States, slots, graph, executor, table row, constants of the machine: all is there after the first case, and a geometric start is placed
/// once for all. The remaining allocations are those of a controller, one for settling and one for the run.
TEST_F(CaseOfAWorker, AllocatesNothingButControllersAfterTheFirst) {
    if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    const std::vector<long> shared = allocations(sweep("shared")), placed = allocations(sweep("settle"));
    EXPECT_GT(shared[0], 1000);
    EXPECT_LE(shared[1], 2);
    EXPECT_LE(placed[1], 3);
    for (const auto& counts : {shared, placed}) {
        for (std::size_t number = 2; number < counts.size(); ++number) EXPECT_EQ(counts[number], counts[1]) << number;
    }
}

TEST_F(CaseOfAWorker, AllocatesNoMoreForALongerCase) {
    if (engine::test::allocation_count() < 0) GTEST_SKIP() << "a sanitizer owns malloc";
    Sweep longer = sweep("shared");
    const long brief = allocations(longer)[1];
    longer.scene.run.until = 3.0 * longer.scene.run.until;
    EXPECT_EQ(allocations(longer)[1], brief);
}

/// Means over time come of samples that lie a share of a pin period apart, or of integrals; outputs only end steps elsewhere, and tips
/// touch and leave at other instants then.
TEST_F(CaseOfAWorker, MeansDoNotDependOnTheOutputInterval) {
    std::ofstream(folder_ / "s.toml")
        << "[sweep]\nscene = \"baseline\"\ndetail = \"rigid\"\n[set]\nrun.until = \"20 ms\"\nrun.state_interval = \"20 ms\"\n"
           "start.settling_time = \"10 ms\"\nstart.ramp_time = \"3 ms\"\n"
           "[[axes]]\nkey = \"run.output_interval\"\nvalues = [\"20 us\", \"712.9 us\", \"5 ms\"]\n[start]\nmode = \"shared\"\n"
           "[outputs]\nscalars = [\"slip mean\", \"tight_tension mean\", \"tips/axial_force[*] rms\", \"shaft_2/chain_torque mean\", "
           "\"loss/total mean\", \"shaft_1/speed mean\"]\n";
    const Sweep sweep = written();
    Worker worker(sweep, folder_);
    const CaseResult first = worker.engine.run(0);
    ASSERT_EQ(first.status, CaseStatus::ok) << first.error;
    for (long number = 1; number < sweep.cases(); ++number) {
        const CaseResult& other = worker.engine.run(number);
        ASSERT_EQ(other.status, CaseStatus::ok) << other.error;
        for (std::size_t i = 0; i < sweep.scalars.size(); ++i)
            EXPECT_NEAR(other.scalars[i], first.scalars[i], 5e-3 * std::abs(first.scalars[i])) << sweep.scalars[i].text << ", " << number;
    }
}

/// 12 ms are 4.6 pin periods of a machine under way: means over all of them differ by 1 to 3 % from those of whole periods.
TEST_F(CaseOfAWorker, AveragesOverTheWholePinPeriodsOfTheSummary) {
    std::ofstream(folder_ / "s.toml")
        << "[sweep]\nscene = \"tiny\"\ndetail = \"rigid\"\n[set]\nrun.until = \"12 ms\"\nrun.output_interval = \"50 us\"\n"
           "[[axes]]\nkey = \"load.torque\"\nvalues = [\"8 N*m\"]\n[outputs]\nscalars = [\"slip mean\", \"tight_tension mean\", "
           "\"efficiency mean\", \"shaft_2/chain_torque mean\"]\n";
    const Sweep sweep = written();
    Worker worker(sweep, folder_);
    const CaseResult& of_case = worker.engine.run(0);
    ASSERT_EQ(of_case.status, CaseStatus::ok) << of_case.error;
    const SpanMeans whole = run_scene(scene_of_case(sweep, 0), {}).whole;
    const double expected[] = {whole.slip, whole.tight, whole.efficiency, whole.chain_torque[1]};
    // Samples lie at other places, 16 and 10 or more in a period; efficiencies come of energies.
    const double tolerance[] = {3e-3, 3e-3, 1e-6, 3e-3};
    for (std::size_t i = 0; i < sweep.scalars.size(); ++i)
        EXPECT_NEAR(of_case.scalars[i], expected[i], tolerance[i] * std::abs(expected[i])) << sweep.scalars[i].text;
}

/// Two machines far from their limits, and one whose time is too short: a case that ends when it is steady states errors that three times
/// its time confirms, whether control keeps the ratio or the sheave is held.
TEST_F(CaseOfAWorker, EndsWhenItIsSteady) {
    const auto steady = [this](const std::string& set) {
        std::ofstream(folder_ / "s.toml")
            << "[sweep]\nscene = \"control\"\ndetail = \"rigid\"\n[set]\nstart.state = \"\"\nstart.settling_time = \"30 ms\"\n"
               "run.until = \"steady\"\ndrive.speed = \"4000 rpm\"\n"
            << set
            << "[[axes]]\nkey = \"load.torque\"\nvalues = [\"80 N*m\"]\n[outputs]\nscalars = [\"tight_tension mean\", "
               "\"friction_slip mean\", \"tight_tension max\", \"shaft_1/clamping mean / shaft_2/clamping mean\", \"slack_tension "
               "mean\"]\n[start]\nmode = "
               "\"settle\"\n";
        return written();
    };
    CaseResult is;
    for (const std::string hold : {"control.gains = \"found\"\ncontrol.when_steady = \"hold\"\n", ""}) {
        const Sweep sweep = steady(hold + "run.steady = \"2 %\"\nrun.output_interval = \"200 us\"\n");
        Worker worker(sweep, folder_);
        const CaseResult before = is;
        is = worker.engine.run(0);
        ASSERT_EQ(is.status, CaseStatus::ok) << is.error;
        EXPECT_GT(is.settled_for, 0.01);
        EXPECT_TRUE(std::isnan(is.errors[2])) << "the largest of all has no error";
        const CaseResult longer = worker.engine.run_from_own_start(0, 6.0 * is.settled_for);
        ASSERT_EQ(longer.status, CaseStatus::ok) << longer.error;
        EXPECT_NEAR(longer.settled_for, 3.0 * is.settled_for, 0.1 * longer.settled_for);
        for (const std::size_t k : {0u, 1u, 3u, 4u}) {
            EXPECT_NEAR(is.scalars[k], longer.scalars[k], is.errors[k] * std::abs(is.scalars[k])) << k;
            if (!hold.empty()) continue;
            EXPECT_NEAR(is.scalars[k], before.scalars[k], 1.5 * is.errors[k] * std::abs(is.scalars[k])) << k << ", held before";
        }
        EXPECT_EQ(worker.engine.run(0).hash, is.hash);
    }
    const Sweep brief = steady("run.steady_limit = 1\nrun.steady = \"0.5 %\"\n");
    Worker ending(brief, folder_);
    const CaseResult& early = ending.engine.run(0);
    EXPECT_EQ(early.status, CaseStatus::not_steady);
    EXPECT_TRUE(early.error.find("not steady at t =") != std::string::npos) << early.error;
    EXPECT_NEAR(early.scalars[0], is.scalars[0], 0.1 * is.scalars[0]) << "the means of what there was";
    EXPECT_LT(early.balance_error_ratio, 1.0);
}

/// A line of loads whose last step is too far to be extrapolated: mean states of cases, moved along the line, make starts that are steady
/// in less than half of the time, within what errors state.
TEST_F(CaseOfAWorker, StartsFromMeanStatesOfTheCasesBefore) {
    std::ofstream(folder_ / "s.toml")
        << "[sweep]\nscene = \"control\"\ndetail = \"rigid\"\n[set]\nstart.state = \"\"\nstart.settling_time = \"30 ms\"\n"
           "run.until = \"steady\"\ndrive.speed = \"4000 rpm\"\ncontrol.gains = \"found\"\ncontrol.when_steady = \"hold\"\n"
           "run.output_interval = \"200 us\"\n[[axes]]\nkey = \"load.torque\"\nvalues = [\"50 N*m\", \"60 N*m\", \"70 N*m\", "
           "\"100 N*m\"]\n[outputs]\nscalars = [\"tight_tension mean\", \"friction_slip mean\", \"ratio mean\", "
           "\"shaft_1/clamping mean / shaft_2/clamping mean\"]\n[start]\nmode = \"settle\"\ncontinuation = \"load.torque\"\n";
    const Sweep sweep = written();
    Worker worker(sweep, folder_);
    std::vector<CaseResult> cases;
    for (long number = 0; number < 4; ++number) {
        cases.push_back(worker.engine.run(number));
        ASSERT_EQ(cases.back().status, CaseStatus::ok) << cases.back().error;
    }
    const std::string_view starts[] = {"settled", "continued", "extrapolated", "continued"};
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(cases[k].start, starts[k]) << k;
    const CaseResult alone = worker.engine.run_from_own_start(2);
    ASSERT_EQ(alone.status, CaseStatus::ok) << alone.error;
    EXPECT_LT(cases[2].settled_for, 0.5 * alone.settled_for);
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(cases[2].scalars[k], alone.scalars[k],
                    std::hypot(cases[2].errors[k] * cases[2].scalars[k], alone.errors[k] * alone.scalars[k]))
            << k;
    }
    Worker another(sweep, folder_);  // ends are in files
    EXPECT_EQ(another.engine.run(2).hash, cases[2].hash);
    EXPECT_EQ(another.engine.run(3).hash, cases[3].hash);
}

model::StartState start_with(const std::string& setting) { return model::start_state(claims::ready_scene("tiny", {setting}).parameters); }

TEST(StartStates, PlacingDependsOnMachineSpeedAndStartAndNotOnWhatIsDoneOnceItStands) {
    const model::StartState plain = model::start_state(claims::ready_scene("tiny").parameters);
    for (const std::string setting :
         {"load.torque=3 N*m", "load.inertia=0.1 kg*m^2", "clamping.driving=7 kN", "clamping.driven=6 kN", "run.step=1 us", "run.until=1 s",
          "run.method=dumka3-p5", "run.seed=7", "run.output_interval=3 us", "run.tolerance=2"}) {
        ASSERT_FALSE(matters_for_placing(*find_parameter(setting.substr(0, setting.find('='))))) << setting;
        EXPECT_EQ(start_with(setting).state, plain.state) << setting;
        EXPECT_EQ(start_with(setting).phases, plain.phases) << setting;
    }
    const std::set<std::string_view> placing{"detail", "chain", "half",    "plate", "joint", "tip",
                                             "pulley", "drive", "control", "start", "record"};
    for (const Parameter& parameter : parameter_table())
        EXPECT_TRUE(!placing.contains(parameter.section()) || matters_for_placing(parameter)) << parameter.key;
    for (const char* setting : {"start.ratio=1.2", "drive.speed=100 rad/s", "tip.radius=100 mm", "control.enabled=true"})
        EXPECT_NE(start_with(setting).state, plain.state) << setting;
}

}  // namespace
}  // namespace cvtflow::tasks
