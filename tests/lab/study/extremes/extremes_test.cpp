/// The program gives a right answer at the edges of every key or states why not.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "bench/study/extremes/extremes.hpp"
#include "model/observe/observation.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::bench {

using namespace tasks;
namespace {

Scene tiny() { return read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/tiny.toml"); }

/// Judges rows; reports all cases of those that do not end as stated.
void judge_rows(const std::vector<Extreme>& rows) {
    ASSERT_FALSE(rows.empty());
    const ExtremeJudge judge(tiny());
    for (const Extreme& row : rows) {
        const ExtremeResult result = judge.judge(row);
        EXPECT_TRUE(result.passed) << row.group << ", " << row.name << ": " << result.outcome();
        for (const ExtremeCase& one : result.cases) {
            if (!result.passed) ADD_FAILURE() << one.detail << ", " << one.method << ": " << ending_name(one.ending) << " " << one.message;
            EXPECT_FALSE(one.ending != Ending::right && one.message.empty()) << row.name << ": an end without a word";
        }
    }
}

[[nodiscard]] std::vector<Extreme> rows(bool nightly) {
    std::vector<Extreme> all = extremes();
    std::erase_if(all, [=](const Extreme& row) { return row.nightly != nightly; });
    return all;
}

/// A few of the rows; CVTFLOW_TEST_SEED draws others.
TEST(Extremes, EndAsStated) { judge_rows(cvtflow::test::sample(rows(false), cvtflow::test::depth<std::size_t>(30, 90), "extremes")); }
TEST(NightlyExtremes, EndAsStated) { judge_rows(rows(false)); }
TEST(NightlyExtremes, OfTenThousandPins) { judge_rows(rows(true)); }

TEST(Extremes, HaveNamesOfTheirOwn) {
    std::set<std::string> names;
    for (const Extreme& row : extremes()) EXPECT_TRUE(names.insert(row.group + "/" + row.name).second) << row.group << ", " << row.name;
    EXPECT_GT(names.size(), 1000u);
}

/// Short steps of the cheapest method show errors that grow with their number.
void run_long(long steps) {
    Scene scene = tiny();
    const double step = 1e-9;
    set_values(scene, std::vector<std::string>{"start.settling_time=0.3 ms", "start.ramp_time=0.3 ms", "record.ledger=true",
                                               "run.schedule=serial"});
    Simulation settled(scene);
    SilentObserver silent;
    const engine::Cancellation never;
    ASSERT_FALSE(settled.advance({.until = 0.0}, silent, never));
    const IntegrationState start = settled.integration_state();
    scene.run.method = "euler";
    scene.run.step = step;
    scene.run.output_interval = 1e-6;
    Simulation simulation(scene);
    simulation.restore(start);
    model::Observer observer(simulation.workspace().variator);
    const auto energy = [&] {
        const model::ChainLayout& at = simulation.workspace().layout();
        double sum = 0.0;
        for (const double part : simulation.workspace().observed_by(observer, simulation.time()).account.energy) sum += part;
        for (int k = 0; k < model::loss_kinds; ++k) sum += simulation.workspace().state()[at.ledger_begin() + k];
        for (int k = 0; k < model::work_kinds; ++k) sum -= simulation.workspace().state()[at.ledger_begin() + model::loss_kinds + k];
        return sum;
    };
    const double before = energy();
    const double span = static_cast<double>(steps) * step;
    ASSERT_FALSE(simulation.advance({.until = span}, silent, never));
    // Times come from counting, not from adding up: 1e8 additions of 1e-9 would be off by 1e-12.
    EXPECT_NEAR(simulation.time(), span, 1e-9 * scene.run.output_interval);
    const Counters& counters = simulation.counters();
    EXPECT_EQ(counters.steps - counters.truncated, steps) << "every grid point is reached once";
    EXPECT_GE(counters.evaluations, counters.steps);
    EXPECT_LE(counters.evaluations, counters.steps + 2 * counters.truncated + counters.steps / 100);
    // Euler at h = 1 ns gains or loses h/2 times the squared frequency of what vibrates: 1e-3 of the whole is far above that.
    EXPECT_NEAR(energy(), before, 1e-3 * before);
    for (int k = 0; k < simulation.workspace().layout().size(); ++k) ASSERT_TRUE(std::isfinite(simulation.workspace().state()[k]));
}

TEST(Extremes, AHundredThousandStepsDriftNowhere) { run_long(100'000); }
TEST(NightlyExtremes, AHundredMillionStepsDriftNowhere) { run_long(100'000'000); }

}  // namespace
}  // namespace cvtflow::bench
