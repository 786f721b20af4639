/// Statements of `info` and of the summary about a run: the step that was taken, uncounted quantities, and tables of sweeps.

#include <gmock/gmock.h>
#include <hdf5.h>

#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/state_file.hpp"
#include "tests/tools/batch_fixture.hpp"
#include "tests/tools/forgery_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class Info : public Sweeps {
protected:
    const Words settled_{"--set", "start.settling_time=1ms", "--set", "start.ramp_time=0.5ms"};

    [[nodiscard]] std::string info(const std::string& file) const { return run({"info", file}).out; }
    [[nodiscard]] double taken(const std::string& file) const {
        const engine::RunReader reader((folder_ / file).string());
        const auto* step = engine::attribute_value<double>(reader.attributes(), "step_taken");
        return step != nullptr ? *step : 0.0;
    }
};

TEST_F(Info, StatesTheStepThatWasTaken) {
    ASSERT_EQ(run(Words{"run", "tiny", "--method", "auto", "--until", "0.1 ms", "-q", "-o", "auto.h5"} + settled_).status, 0);
    EXPECT_NEAR(taken("auto.h5"), 2e-6, 0.5e-6);
    EXPECT_THAT(info("auto.h5"), ContainsRegex("\n  method              leapfrog-sweep, step auto \\([0-9.]+ us\\), seed 0\n"));
    ASSERT_EQ(run_briefly({"-q", "-o", "given.h5"}).status, 0);
    EXPECT_NEAR(taken("given.h5"), 50e-9, 1e-12);
    EXPECT_THAT(info("given.h5"), HasSubstr("step 50 ns, seed 0\n"));
    ASSERT_EQ(run(Words{"settle", "tiny", "-q", "-o", "state.h5"} + settled_).status, 0);
    EXPECT_THAT(info("state.h5"), ContainsRegex("rk4 with step auto \\([0-9.]+ ns\\), 1 ms of settling\n"));
}

TEST_F(Info, OfFilesOfEarlierProgramsStatesTheSettingAlone) {
    ASSERT_EQ(run(Words{"run", "tiny", "--until", "0.1 ms", "-q", "-o", "old.h5"} + settled_).status, 0);
    change_record((folder_ / "old.h5").string(), [](hid_t file) { H5Adelete(file, "step_taken"); });
    EXPECT_THAT(info("old.h5"), HasSubstr("rk4, step auto, seed 0\n"));
}

TEST_F(Info, CountsTransitionsOfRigidPins) {
    const Outcome outcome =
        run(Words{"run", "tiny", "--detail", "rigid", "--method", "auto", "--until", "1 ms", "-o", "rigid.h5"} + settled_);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, ContainsRegex("  transitions         [1-9][0-9]* detected, 0 steps truncated, 0 suppressed"));
}

TEST_F(Info, DescribesTheTableOfASweep) {
    write_sweep("\"6 N*m\"");
    ASSERT_EQ(batch({"-q"}).status, 0);
    for (const char* path : {"out", "out/cases.h5"}) {
        const std::string text = info(path);
        EXPECT_THAT(text,
                    AllOf(HasSubstr("out/cases.h5: results of a sweep, "), HasSubstr(" ok\n"), HasSubstr("status              finished"),
                          HasSubstr("cvtflow table " + std::string(path)), HasSubstr("energy_residual")));
        EXPECT_THAT(text, HasSubstr(table().attribute("results_hash")));
    }
}

}  // namespace
}  // namespace cvtflow::tools
