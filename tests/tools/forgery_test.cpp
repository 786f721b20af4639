#include "tests/tools/forgery_fixture.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <utility>

#include "engine/base/text.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

/// One of our files, and the commands that read it.
struct Target {
    std::string file;
    Forged kind;
    std::vector<Words> commands;
};

const Words brief{"--set", "start.settling_time=20us", "--set", "start.ramp_time=10us"};
const Words once{"--set", "run.max_steps=20", "-q"};

std::vector<Target> targets() {
    const std::vector<Words> of_record{{"info", "good.h5"},
                                       {"table", "good.h5", "--rainflow", "ratio"},
                                       {"table", "good.h5", "--rainflow", "links/tension[*]", "--csv"},
                                       {"plot", "good.h5"},
                                       {"plot", "good.h5", "--orders", "-o", "p.csv"},
                                       {"plot", "good.h5", "--losses"},
                                       {"plot", "good.h5", "--round"},
                                       {"report", "good.h5"},
                                       {"report", "good.h5", "cut.h5"},
                                       {"export", "good.h5", "--csv", "wide.csv"},
                                       {"export", "good.h5", "--vtk", "v.pvd"}};
    const std::vector<Words> of_state{{"info", "state.h5"},
                                      {"check", "tiny", "--set", "start.state=state.h5"},
                                      Words{"run", "tiny", "-o", "none", "--set", "start.state=state.h5"} + once,
                                      Words{"settle", "tiny", "-q", "-o", "again.h5", "--time", "10us", "--set", "start.state=state.h5"}};
    const std::vector<Words> of_checkpoint{{"info", "cut.checkpoint.h5"},
                                           Words{"resume", "cut.checkpoint.h5", "-o", "none"} + once,
                                           Words{"resume", "cut.checkpoint.h5"} + once};
    const std::vector<Words> of_table{{"table", "out"},
                                      {"table", "out", "--csv"},
                                      {"report", "out"},
                                      {"plot", "out"},
                                      {"resume", "out", "-q"},
                                      {"merge", "out"},
                                      {"batch", "sweep.toml", "-o", "out", "-q"}};
    return {{"good.h5", Forged::record, of_record},
            {"state.h5", Forged::state, of_state},
            {"cut.checkpoint.h5", Forged::state, of_checkpoint},
            {"out/cases.h5", Forged::table, of_table},
            {"cut.h5", Forged::record, {{"resume", "cut.checkpoint.h5", "-q"}}},
            {"shards/workers/0001/cases.h5", Forged::table, {{"merge", "shards"}, {"merge", "shards", "--partial"}}}};
}

/// Forgeries of a record, a state, a checkpoint and a table go through every command that reads them.
class Forgery : public Sweeps {
protected:
    Forgery() {
        made_once("good files", [this] { make(); });
    }
    void make() const {
        EXPECT_EQ(
            run(Words{"run", "tiny", "--settle", "-q", "-o", "good.h5", "--until", "40 us", "--set", "run.state_interval=10us"} + brief)
                .status,
            0);
        EXPECT_EQ(run({"settle", "tiny", "-q", "-o", "state.h5", "--time", "20us", "--set", "start.ramp_time=10us"}).status, 0);
        EXPECT_EQ(run(run_to_be_ended("cut.h5") + Words{"--checkpoint-every", "1 h", "--set", "run.max_steps=3000"}).status, 4);
        write_sweep("\"6 N*m\"");
        EXPECT_EQ(batch().status, 0);
        for (const char* shard : {"1/2", "2/2"}) EXPECT_EQ(run({"batch", "sweep.toml", "-o", "shards", "--shard", shard}).status, 0);
    }
    /// A false file made from a good one. @return description of the change
    using Forge = std::function<std::string(const std::string& path)>;
    /// Runs the commands on a forged copy of a file, in a separate folder.
    void survive(const Target& target, const Forge& forge);
    /// Drawn changes of contents whose hashes are right, and of structure.
    void survive_drawn(std::uint64_t first, std::uint64_t seeds);
    /// Runs `count` of all changes of all objects and attributes, all of them if the seed of samples is "all"; of these one of equal parts.
    void survive_objects(std::size_t count, std::size_t part = 0, std::size_t parts = 1);

    void expect_survived(const Words& words, const std::string& what);
};

void Forgery::expect_survived(const Words& words, const std::string& what) {
    constexpr unsigned seconds = 120;  // of a machine that is busy with other things
    Child child(words, folder_ / "lair", {}, seconds);
    const Outcome outcome = child.wait();
    const std::string line = testing::PrintToString(words) + " on " + what + ": " + outcome.err.substr(0, 2000);
    EXPECT_LE(outcome.status, 7) << line;
    EXPECT_EQ(outcome.err.find("an error in this program"), std::string::npos) << line;
    for (const std::string& text : {outcome.out, outcome.err}) {
        EXPECT_EQ(engine::visible(text).size(), text.size()) << "control characters: " << line;
    }
#ifndef __SANITIZE_ADDRESS__
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    EXPECT_LE(used.ru_maxrss, 512 * 1024) << line;
#endif
}

void Forgery::survive(const Target& target, const Forge& forge) {
    namespace fs = std::filesystem;
    for (const Words& words : target.commands) {
        fs::remove_all(folder_ / "lair");
        fs::create_directories(folder_ / "lair");
        write("victim.txt", "mine");
        for (const char* beside : {"good.h5", "cut.h5.part", "cut.h5", "cut.checkpoint.h5", "sweep.toml"}) {
            if (exists(beside)) fs::copy_file(folder_ / beside, folder_ / "lair" / beside);
        }
        for (const char* folder : {"out", "shards"}) fs::copy(folder_ / folder, folder_ / "lair" / folder, fs::copy_options::recursive);
        const fs::path copy = folder_ / "lair" / target.file;
        fs::copy_file(folder_ / target.file, copy, fs::copy_options::overwrite_existing);
        const std::string what = target.file + ", " + forge(copy.string());
        expect_survived(words, what);
        EXPECT_EQ(read("victim.txt"), "mine") << what;
        if (HasFailure()) break;
    }
}

void Forgery::survive_drawn(std::uint64_t first, std::uint64_t seeds) {
    const std::vector<Target> all = targets();
    for (std::uint64_t seed = first; seed < first + seeds && !HasFailure(); ++seed) {
        const Target& target = all[seed % all.size()];
        survive(target, [&](const std::string& path) { return "seed " + std::to_string(seed) + ": " + forge(path, target.kind, seed); });
    }
}

void Forgery::survive_objects(std::size_t count, std::size_t part, std::size_t parts) {
    using Pair = std::pair<const Target*, ObjectForgery>;
    const std::vector<Target> all = targets();
    std::vector<Pair> forgeries;
    for (const Target& target : all) {
        for (const ObjectForgery& each : forgeries_of((folder_ / target.file).string())) forgeries.emplace_back(&target, each);
    }
    const std::vector<Pair> taken = test::sample(forgeries, count, "forgeries");
    for (; part < taken.size(); part += parts) {
        const auto& [target, forgery] = taken[part];
        survive(*target, [&forgery = forgery](const std::string& path) { return forgery.make(path), forgery.text(); });
        if (HasFailure()) break;
    }
    std::cout << taken.size() << " of " << forgeries.size() << " changes of objects and attributes\n";
}

TEST_F(Forgery, NeitherCrashesNorSwellsACommand) {
    survive_drawn(0, test::depth(3, 12));
    survive_objects(test::depth(3, 12));
}

/// 2,000 drawn ones, 3,000 of objects.
class NightlyForgery : public Forgery, public testing::WithParamInterface<std::size_t> {
protected:
    static constexpr std::size_t parts = 20;
};

TEST_P(NightlyForgery, OfDrawnContentsNeitherCrashesNorSwellsACommand) { survive_drawn(GetParam() * 2000 / parts, 2000 / parts); }

TEST_P(NightlyForgery, OfObjectsNeitherCrashesNorSwellsACommand) { survive_objects(3000, GetParam(), parts); }

INSTANTIATE_TEST_SUITE_P(Parts, NightlyForgery, testing::Range<std::size_t>(0, 20));

/// One change each, as it was found; the program must say what is wrong.
class ForgedRecord : public Program {
protected:
    ForgedRecord() {
        made_once("a good record", [this] { EXPECT_EQ(run_briefly({"-o", "good.h5", "--set", "run.state_interval=10us"}).status, 0); });
    }
    /// A copy of the record, changed and sealed again.
    template <class Change>
    void forged(const Change& change) const {
        std::filesystem::copy_file(folder_ / "good.h5", folder_ / "bad.h5", std::filesystem::copy_options::overwrite_existing);
        change_record((folder_ / "bad.h5").string(), change);
    }
    /// Peak memory of a command, which must end with an error that contains `why` [MB].
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
    refused({"report", "bad.h5"}, "bad.h5: state 0 does not match its machine");
    refused({"export", "bad.h5", "--vtk", "v.pvd"}, "bad.h5: state 0 does not match its machine");
    forged([](hid_t file) { replace_dataset(file, "states/phases", H5T_NATIVE_UINT8, {100, 3}, false); });
    refused({"report", "bad.h5"}, "bad.h5: state 0 does not match its machine");
}

TEST_F(ForgedRecord, ThatPromisesMoreThanItHasTakesNoMemory) {
    forged([](hid_t file) { replace_dataset(file, "channels/ratio", H5T_NATIVE_DOUBLE, {10'000'000, 1}, true); });
    for (const Words& words : {Words{"info", "bad.h5"}, Words{"report", "bad.h5"}, Words{"table", "bad.h5", "--rainflow", "ratio"}})
        EXPECT_LT(refused(words, "its data would need far more memory than the size of the file"), 512.0);
    forged([](hid_t file) { put_text(file, "channels/ratio", "units", std::string(60'000, 'x')); });
    EXPECT_LT(refused({"info", "bad.h5"}, "a name or description of 60000 bytes"), 512.0);
}

TEST_F(ForgedRecord, WhoseTimesRunBackwardsOrWhoseNamesHaveEscapesIsRefused) {
    forged([](hid_t file) { fill_with_nan(file, "channels/time"); });
    refused({"report", "bad.h5"}, "bad.h5: damaged: times do not increase");
    forged([](hid_t file) { put_text(file, "channels/ratio", "units", "\x1b]0;title\x07"); });
    refused({"info", "bad.h5"}, "control characters");
}

}  // namespace
}  // namespace cvtflow::tools
