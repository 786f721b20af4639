/// Start states of the cases of a sweep.

#include <gmock/gmock.h>

#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::Each;
using testing::HasSubstr;
using testing::Pair;

class BatchStart : public Sweeps {
protected:
    /// Three cases of baseline, whose settled state is of level `fine`.
    void write_of_baseline(const std::string& set, const std::string& more = "") const {
        write("sweep.toml", "[sweep]\nscene = \"baseline\"\n" + more +
                                "[set]\nrun.until = \"20 us\"\nrun.step = \"1 us\"\nstart.ramp_time = \"20 us\"\nstart.settling_time = \"" +
                                set +
                                "\n[[axes]]\nkey = \"load.torque\"\nvalues = [\"10 N*m\", \"20 N*m\", \"30 N*m\"]\n[outputs]\nscalars = "
                                "[\"ratio mean\"]\n");
    }
};

TEST_F(BatchStart, CasesOfAnotherLevelOfDetailThanTheScenesStateSettleAsRunsDo) {
    write_of_baseline("20 us\"\n", "detail = \"rigid\"\n");
    const Outcome outcome = batch();
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(column("status"), Each(Pair(testing::_, "ok")));
    EXPECT_THAT(column("start"), Each(Pair(testing::_, "geometric")));
    const Outcome single = run({"run", "baseline", "-o", "none", "--detail", "rigid", "--until", "20 us", "--step", "1 us", "--set",
                                "start.settling_time=20us", "--set", "start.ramp_time=20us", "--set", "load.torque=20 N*m"});
    EXPECT_THAT(single.out, HasSubstr("state hash          " + column("hash").at(1)));
}

TEST_F(BatchStart, CasesOfOtherPulleysThanTheScenesStateSettle) {
    write_of_baseline("20 us\"\ndetail.pulleys = \"rigid\"\n");
    const Outcome outcome = batch();
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    EXPECT_THAT(column("start"), Each(Pair(testing::_, "geometric")));
}

TEST_F(BatchStart, CasesThatMustSettleButHaveNoTimeForItSayWhy) {
    write_of_baseline("0 s\"\n", "detail = \"rigid\"\n");
    EXPECT_EQ(batch().status, 5);
    EXPECT_THAT(column("error"), Each(Pair(testing::_, HasSubstr("start.settling_time = 0 leaves no time to settle"))));
}

TEST_F(BatchStart, NamesTheCommandOfAFileOfTheOtherKind) {
    write("t.toml", "[scene]\nname = \"t\"\n\n[chain]\npins = 24\n\n[tips]\nx = 1\n");
    write_sweep();
    EXPECT_EQ(run({"batch", "t.toml"}).err, "cvtflow: t.toml:4:2: chain: this is a scene, not a sweep; to run it: cvtflow run t.toml\n");
    EXPECT_EQ(run({"run", "sweep.toml"}).err,
              "cvtflow: sweep.toml:1:2: sweep: this is a sweep, not a scene; to run it: cvtflow batch sweep.toml\n");
    EXPECT_EQ(run({"batch", "tiny"}).err,
              "cvtflow: no sweep 'tiny'; ready sweeps: operating_map, slip_efficiency, steady_map; to run the scene of that name: "
              "cvtflow run tiny\n");
    EXPECT_EQ(run({"run", "slip_efficiency"}).err,
              "cvtflow: 'slip_efficiency' is a ready sweep, not a scene; to run it: cvtflow batch slip_efficiency\n");
}

}  // namespace
}  // namespace cvtflow::tools
