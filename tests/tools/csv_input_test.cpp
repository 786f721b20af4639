/// Inputs from CSV files and laws of their own, through the program.

#include <gmock/gmock.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;

class CsvInput : public Program {
protected:
    CsvInput() { write("load.csv", "t [us],M [N*m]\n0,12\n30,12\n50,15\n"); }

    [[nodiscard]] static std::string hash_in(const std::string& text) {
        const auto at = text.find("state hash");
        return at == std::string::npos ? "none" : text.substr(text.find_first_not_of(' ', at + 10), 16);
    }
    static inline const std::vector<std::string> all{"--until", "60 us",
                                                     "--set",   "load.torque={csv = \"load.csv\"}",
                                                     "--set",   "load.quadratic=1e-4",
                                                     "--set",   "clamping.safety=1.1",
                                                     "--set",   "control.enabled=true",
                                                     "--set",   "control.quantity=slip",
                                                     "--set",   "record.channels=tips/*",
                                                     "--set",   "start.settling_time=20us",
                                                     "--set",   "start.ramp_time=10us"};
};

TEST_F(CsvInput, ARunContinuesBitForBitWithoutTheFileAndWhateverTheThreads) {
    const std::vector<std::string> run_tiny{"run", "tiny", "-q"};
    ASSERT_EQ(run(run_tiny + all + std::vector<std::string>{"-o", "whole.h5", "--threads", "1"}).status, 0);
    const std::string whole = hash_in(run({"info", "whole.h5"}).out);
    ASSERT_NE(whole, "none");
    ASSERT_EQ(run(run_tiny + all + std::vector<std::string>{"-o", "parallel.h5", "--threads", "2", "--set", "run.schedule=flow"}).status,
              0);
    EXPECT_EQ(hash_in(run({"info", "parallel.h5"}).out), whole);
    const std::vector<std::string> cut{"-o", "cut.h5", "--checkpoint-every", "1 h", "--set", "run.max_steps=40"};
    ASSERT_EQ(run(run_tiny + all + cut).status, 4);
    std::filesystem::remove(folder_ / "load.csv");
    const Outcome resumed = run({"resume", "cut.checkpoint.h5", "-q", "--set", "run.max_steps=0"});
    ASSERT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(hash_in(run({"info", "cut.h5"}).out), whole);
    EXPECT_THAT(run({"info", "cut.h5"}).out, HasSubstr("tips/radial_force"));
}

TEST_F(CsvInput, ErrorsAreReportedWithPlaceInSceneAndFile) {
    write("load.csv", "t,M\n0,12\n1,1e9\n");
    const Outcome outcome = run({"check", "tiny", "--set", "load.torque={csv = \"load.csv\"}"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("load.torque: 1e9 N*m is outside [-1e5, 1e5] N*m (load.csv:3:2)"));
}

TEST_F(CsvInput, ChannelsThatDoNotExistAreAnErrorOfTheScene) {
    const Outcome outcome = run({"check", "tiny", "--set", "record.channels=[\"tips/*\", \"tips/normal_froce\"]"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.err, HasSubstr("unknown channel 'tips/normal_froce' (did you mean \"tips/normal_force\"?)"));
}

}  // namespace
}  // namespace cvtflow::tools
