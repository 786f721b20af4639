#include "tests/tools/forgery_fixture.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>

#include "engine/base/error_text.hpp"
#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

/// Forgeries of a record, a state, a checkpoint and a table go through every command that reads them.
class Forgery : public Sweeps {
protected:
    Forgery() {
        const Words brief{"--set", "start.settling_time=20us", "--set", "start.ramp_time=10us", "--until", "40 us"};
        EXPECT_EQ(run(Words{"run", "tiny", "--settle", "-q", "-o", "good.h5", "--set", "run.state_interval=10us"} + brief).status, 0);
        EXPECT_EQ(run({"settle", "tiny", "-q", "-o", "state.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
        EXPECT_EQ(run(run_to_be_ended("cut.h5") + Words{"--checkpoint-every", "1 h", "--set", "run.max_steps=3000"}).status, 4);
        write_sweep("\"6 N*m\"");
        EXPECT_EQ(batch().status, 0);
    }
    /// Runs the commands on a forged copy of a file, in a folder of its own.
    void survive(const std::string& good, Forged kind, std::uint64_t seed, const std::vector<Words>& commands);
    void survive_all(std::uint64_t seeds);

    void expect_survived(const Words& words, const std::string& what);
};

void Forgery::expect_survived(const Words& words, const std::string& what) {
    constexpr unsigned seconds = 120;  // of a machine that is busy with other things
    Child child(words, folder_ / "lair", {}, seconds);
    const Outcome outcome = child.wait();
    const std::string line = testing::PrintToString(words) + " on " + what + ": " + outcome.err.substr(0, 2000);
    EXPECT_LE(outcome.status, 7) << line;
    EXPECT_EQ(outcome.err.find("a mistake in this program"), std::string::npos) << line;
    for (const std::string& text : {outcome.out, outcome.err}) {
        EXPECT_EQ(engine::visible(text).size(), text.size()) << "control characters: " << line;
    }
#ifndef __SANITIZE_ADDRESS__
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    EXPECT_LE(used.ru_maxrss, 512 * 1024) << line;
#endif
}

void Forgery::survive(const std::string& good, Forged kind, std::uint64_t seed, const std::vector<Words>& commands) {
    namespace fs = std::filesystem;
    for (const Words& words : commands) {
        fs::remove_all(folder_ / "lair");
        fs::create_directories(folder_ / "lair");
        write("victim.txt", "mine");
        const std::string name = fs::path(good).filename().string();
        for (const char* beside : {"good.h5", "cut.h5.part", "cut.h5", "cut.checkpoint.h5"}) {
            if (exists(beside)) fs::copy_file(folder_ / beside, folder_ / "lair" / beside);
        }
        if (kind == Forged::table) fs::copy(folder_ / "out", folder_ / "lair/out", fs::copy_options::recursive);
        const fs::path copy = folder_ / "lair" / (kind == Forged::table ? "out/cases.h5" : name);
        fs::copy_file(folder_ / good, copy, fs::copy_options::overwrite_existing);
        const std::string what = good + ", seed " + std::to_string(seed) + ": " + forge(copy.string(), kind, seed);
        expect_survived(words, what);
        EXPECT_EQ(read("victim.txt"), "mine") << what;
        if (HasFailure()) break;
    }
}

void Forgery::survive_all(std::uint64_t seeds) {
    const std::vector<Words> of_record{{"info", "good.h5"},
                                       {"table", "good.h5", "--rainflow", "ratio"},
                                       {"table", "good.h5", "--rainflow", "links/tension[*]", "--csv"},
                                       {"plot", "good.h5"},
                                       {"plot", "good.h5", "--orders", "-o", "p.csv"},
                                       {"plot", "good.h5", "--losses"},
                                       {"plot", "good.h5", "--round"},
                                       {"report", "good.h5"},
                                       {"report", "good.h5", "cut.h5"},
                                       {"export", "good.h5", "--vtk", "v.pvd"}};
    const Words once{"--set", "run.max_steps=20", "-q"};
    const std::vector<Words> of_state{{"info", "state.h5"}, Words{"run", "tiny", "-o", "none", "--set", "start.state=state.h5"} + once};
    const std::vector<Words> of_checkpoint{{"info", "cut.checkpoint.h5"},
                                           Words{"resume", "cut.checkpoint.h5", "-o", "none"} + once,
                                           Words{"resume", "cut.checkpoint.h5"} + once};
    const std::vector<Words> of_table{{"table", "out"}, {"table", "out", "--csv"}, {"report", "out"},
                                      {"plot", "out"},  {"resume", "out", "-q"},   {"merge", "out"}};
    for (std::uint64_t seed = 0; seed < seeds && !HasFailure(); ++seed) {
        switch (seed % 5) {
            case 0: survive("state.h5", Forged::state, seed, of_state); break;
            case 1: survive("cut.checkpoint.h5", Forged::state, seed, of_checkpoint); break;
            case 2: survive("out/cases.h5", Forged::table, seed, of_table); break;
            case 3: survive("cut.h5", Forged::record, seed, {{"resume", "cut.checkpoint.h5", "-q"}}); break;
            default: survive("good.h5", Forged::record, seed, of_record);
        }
    }
}

TEST_F(Forgery, NeitherCrashesNorSwellsACommand) { survive_all(20); }

using NightlyForgery = Forgery;

/// FORGERIES: how many, for other machines and sanitizers.
TEST_F(NightlyForgery, NeitherCrashesNorSwellsACommand) {
    const char* count = std::getenv("FORGERIES");
    survive_all(count != nullptr ? std::strtoull(count, nullptr, 10) : 5000);
}

/// One change each, as it was found; the program must say what is wrong.
class ForgedRecord : public Program {
protected:
    ForgedRecord() { EXPECT_EQ(run_briefly({"-o", "good.h5", "--set", "run.state_interval=10us"}).status, 0); }
    /// A copy of the record, changed and sealed anew.
    template <class Change>
    void forged(const Change& change) const {
        std::filesystem::copy_file(folder_ / "good.h5", folder_ / "bad.h5", std::filesystem::copy_options::overwrite_existing);
        change_record((folder_ / "bad.h5").string(), change);
    }
    /// Peak memory of a command, which must end with an error that says `why` [MB].
    double refused(const Words& words, const std::string& why) const {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 1) << testing::PrintToString(words);
        EXPECT_THAT(outcome.err, testing::HasSubstr(why));
        rusage used{};
        getrusage(RUSAGE_CHILDREN, &used);
        return 1e-3 * static_cast<double>(used.ru_maxrss);
    }
};

TEST_F(ForgedRecord, OfStatesThatAreNotFiniteIsReportedWithoutThem) {
    forged([](hid_t file) { fill_with_nan(file, "states/y"); });
    EXPECT_EQ(run({"report", "bad.h5"}).status, 0);
    EXPECT_NE(read("bad.html").find("has no states that this program can show"), std::string::npos);
    refused({"export", "bad.h5", "--vtk", "v.pvd"}, "bad.h5: state 0 is not finite");
}

TEST_F(ForgedRecord, WithoutPhasesOrWithTooFewIsRefused) {
    forged([](hid_t file) { H5Ldelete(file, "states/phases", H5P_DEFAULT); });
    refused({"report", "bad.h5"}, "bad.h5: state 0 is not of its machine");
    refused({"export", "bad.h5", "--vtk", "v.pvd"}, "bad.h5: state 0 is not of its machine");
    forged([](hid_t file) { replace_dataset(file, "states/phases", H5T_NATIVE_UINT8, {100, 3}, false); });
    refused({"report", "bad.h5"}, "bad.h5: state 0 is not of its machine");
}

TEST_F(ForgedRecord, ThatPromisesMoreThanItHasTakesNoMemory) {
    forged([](hid_t file) { replace_dataset(file, "channels/ratio", H5T_NATIVE_DOUBLE, {10'000'000, 1}, true); });
    for (const Words& words : {Words{"info", "bad.h5"}, Words{"report", "bad.h5"}, Words{"table", "bad.h5", "--rainflow", "ratio"}})
        EXPECT_LT(refused(words, "its data would take far more memory than the file has bytes"), 512.0);
    forged([](hid_t file) { put_text(file, "channels/ratio", "units", std::string(60'000, 'x')); });
    EXPECT_LT(refused({"info", "bad.h5"}, "a name or description of 60000 bytes"), 512.0);
}

TEST_F(ForgedRecord, WhoseTimesRunBackwardsOrWhoseNamesHaveEscapesIsRefused) {
    forged([](hid_t file) { fill_with_nan(file, "channels/time"); });
    refused({"report", "bad.h5"}, "bad.h5: damaged: its times do not ascend");
    forged([](hid_t file) { put_text(file, "channels/ratio", "units", "\x1b]0;title\x07"); });
    refused({"info", "bad.h5"}, "control characters");
}

}  // namespace
}  // namespace cvtflow::tools
