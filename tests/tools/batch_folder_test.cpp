/// The folder of a sweep: where its rows come from, and what is done about damage.

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "engine/base/provenance.hpp"
#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/state_file.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;

// Rows of a folder come from one program and one start, or from several knowingly.

constexpr const char* other_program = "0.1.0 (deadbeef)";

class BatchOrigin : public Sweeps {
protected:
    /// A state of tiny, settled for a moment with that load.
    void settle(const std::string& file, const std::string& load) const {
        const Outcome outcome = run({"settle", "tiny", "-q", "--force", "-o", file, "--time", "20us", "--set", "start.ramp_time=10us",
                                     "--set", "load.torque=" + load});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    }
    /// Two cases from that state.
    void write_from(const std::string& state, const std::string& outputs = "", const std::string& loads = "6, 12") const {
        write("sweep.toml",
              "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nrun.step = \"50 ns\"\nstart.settling_time = \"20 us\"\n"
              "start.ramp_time = \"10 us\"\nstart.state = \"" +
                  state + "\"\n[[axes]]\nkey = \"load.torque\"\nvalues = [" + loads + "]\n[outputs]\nscalars = [\"slip mean\"]\n" +
                  outputs);
    }
    void shared() const {
        write_sweep("\"6 N*m\"", "20 us", "");
        std::string text = read("sweep.toml");
        text.replace(text.find("\"settle\""), 8, "\"shared\"");
        write("sweep.toml", text);
    }
    /// Gives a folder the traces of another version of the program.
    void give_to_other_program(const std::string& folder) const {
        engine::CaseTable other = table(folder);
        other.set({"program", std::string(other_program)});
        engine::write_cases(engine::Permit((folder_ / folder / "cases.h5").string(), {.force = true}), other);
    }
    void give_state_to_other_program(const fs::path& file) const {
        engine::SavedState state = engine::read_state((folder_ / file).string());
        for (engine::Attribute& attribute : state.attributes) {
            if (attribute.name == "program") attribute.value = "cvtflow " + std::string(other_program) + ", GNU";
        }
        engine::write_state((folder_ / file).string(), state);
    }
    [[nodiscard]] std::vector<fs::path> states_in(const std::string& folder) const {
        std::vector<fs::path> files;
        for (const auto& entry : fs::directory_iterator(folder_ / folder / "states"))
            files.push_back(fs::path(folder) / "states" / entry.path().filename());
        return files;
    }
};

TEST_F(BatchOrigin, IsInEveryRow) {
    settle("a.h5", "6 N*m");
    settle("b.h5", "12 N*m");
    write_from("a.h5");
    ASSERT_EQ(batch().status, 0);
    EXPECT_THAT(column("program"), Each(Pair(testing::_, engine::version_text())));
    write_from("b.h5");
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "b"}).status, 0);
    EXPECT_EQ(column("start_state").at(0), column("start_state").at(1));
    EXPECT_NE(column("start_state").at(0), column("start_state", "b").at(0));
    EXPECT_EQ(column("start_state").at(0).size(), 16u);
}

TEST_F(BatchOrigin, AnotherContentOfTheStartStateIsRefusedAndAnotherPathIsNot) {
    settle("a.h5", "6 N*m");
    write_from("a.h5");
    ASSERT_EQ(batch().status, 0);
    const std::string before = read("out/cases.h5");
    fs::rename(folder_ / "a.h5", folder_ / "c.h5");
    write_from("c.h5");
    EXPECT_EQ(batch().status, 0);
    settle("c.h5", "12 N*m");
    const std::string kept = read("out/cases.h5");
    const Outcome refused = batch();
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err, AllOf(HasSubstr("out/cases.h5: content of start.state "), HasSubstr("--mixed"), Not(HasSubstr("program "))));
    EXPECT_EQ(read("out/cases.h5"), kept);
    EXPECT_EQ(run({"resume", "out"}).status, 1);
    EXPECT_EQ(batch({"--mixed"}).status, 0);
}

TEST_F(BatchOrigin, OfShardsMustAgree) {
    settle("a.h5", "6 N*m");
    write_from("a.h5");
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", "1/2"}).status, 0);
    settle("a.h5", "12 N*m");
    ASSERT_EQ(run({"batch", "sweep.toml", "-o", "cut", "--shard", "2/2"}).status, 0);
    const Outcome starts = run({"merge", "cut"});
    EXPECT_EQ(starts.status, 1);
    EXPECT_THAT(starts.err, HasSubstr("cut/workers/0002/cases.h5: content of start.state "));
    EXPECT_FALSE(exists("cut/cases.h5"));
    give_to_other_program("cut/workers/0001");
    EXPECT_THAT(run({"merge", "cut"}).err, HasSubstr("program 0.1.0 (deadbeef) there, "));
    EXPECT_EQ(run({"merge", "cut", "--mixed"}).status, 0);
    EXPECT_EQ(table("cut").attribute("program"), other_program + std::string("; ") + engine::version_text());
}

TEST_F(BatchOrigin, OfAnotherVersionOfTheProgramIsContinuedOnlyKnowingly) {
    write_sweep();
    ASSERT_EQ(batch().status, 0);
    give_to_other_program("out");
    const std::string kept = read("out/cases.h5");
    for (const Words& command : {Words{"batch", "sweep.toml", "-o", "out"}, Words{"resume", "out"}}) {
        const Outcome refused = run(command);
        EXPECT_EQ(refused.status, 1);
        EXPECT_THAT(refused.err, HasSubstr("out/cases.h5: program 0.1.0 (deadbeef) there, " + engine::version_text() + " here; "));
    }
    EXPECT_EQ(read("out/cases.h5"), kept);
    EXPECT_EQ(run({"resume", "out", "--mixed"}).status, 0);
    EXPECT_EQ(table().attribute("program"), other_program + std::string("; ") + engine::version_text());
    EXPECT_EQ(batch().status, 1) << "it stays mixed";
}

TEST_F(BatchOrigin, RecordsThatAreAskedForLaterAreRefused) {
    settle("a.h5", "6 N*m");
    write_from("a.h5");
    ASSERT_EQ(batch().status, 0);
    write_from("a.h5", "records = true\n");
    const Outcome refused = batch();
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err, HasSubstr("out/cases.h5: outputs.records false there, true here; "));
    EXPECT_FALSE(exists("out/records"));
}

TEST_F(BatchOrigin, OfSharedStatesIsCompared) {
    shared();
    ASSERT_EQ(batch().status, 0);
    ASSERT_EQ(states_in("out").size(), 1u);
    const fs::path state = states_in("out").front();
    fs::create_directories(folder_ / "other" / "states");
    fs::copy_file(folder_ / state, folder_ / "other" / "states" / state.filename());
    give_state_to_other_program(fs::path("other") / "states" / state.filename());
    const Outcome version = run({"batch", "sweep.toml", "-o", "other"});
    EXPECT_EQ(version.status, 1);
    EXPECT_THAT(version.err, AllOf(HasSubstr("a shared start state settled by cvtflow "), HasSubstr("deadbeef"), HasSubstr("--mixed")));
    EXPECT_EQ(run({"batch", "sweep.toml", "-o", "other", "--mixed"}).status, 0);
    settle("stranger.h5", "3 N*m");
    fs::create_directories(folder_ / "third" / "states");
    fs::copy_file(folder_ / "stranger.h5", folder_ / "third" / "states" / state.filename());
    const Outcome scene = run({"batch", "sweep.toml", "-o", "third", "--mixed"});
    EXPECT_EQ(scene.status, 1);
    EXPECT_THAT(scene.err, HasSubstr("a shared start state of another scene than its name promises"));
}

TEST_F(BatchOrigin, OfACheckpointIsCompared) {
    const Words brief = Words{"run", "tiny", "-o", "r.h5", "--until", "1 ms", "--settle", "--checkpoint-every", "1 s"} +
                        set_all({"run.max_steps=400", "start.settling_time=10us", "start.ramp_time=5us"});
    ASSERT_EQ(run(brief).status, 4);
    ASSERT_TRUE(exists("r.checkpoint.h5"));
    give_state_to_other_program("r.checkpoint.h5");
    const Outcome refused = run({"resume", "r.checkpoint.h5", "--set", "run.max_steps=0", "--until", "40 us"});
    EXPECT_EQ(refused.status, 1);
    EXPECT_THAT(refused.err,
                AllOf(HasSubstr("r.checkpoint.h5: written by cvtflow 0.1.0 (deadbeef), GNU, this is cvtflow "), HasSubstr("--mixed")));
    EXPECT_NE(run({"resume", "r.checkpoint.h5", "--mixed", "--set", "run.max_steps=0"}).status, 1);
}

// A sweep is stopped by a hangup (by SIGTERM: ContinuedBatch) and continues with the same results. Files of it are damaged before: cases
// whose checkpoints cannot be used begin again.

class StoppedSweep : public Sweeps {
protected:
    /// Two of four cases, side by side, are stopped with checkpoints and records in out; the whole sweep is in whole.
    void SetUp() override {
        made_once("a stopped sweep", [this] { make(); });
    }

    void make() const {
        write_sweep("\"6 N*m\"", "0.6 ms");
        add_records();
        const Outcome whole = run({"batch", "sweep.toml", "-o", "whole"});
        ASSERT_EQ(whole.status, 0) << whole.err;
        Child child({"batch", "sweep.toml", "-o", "out", "--threads", "2", "--grace", "1 us", "--checkpoint-every", "10 ms"}, folder_);
        const auto begun = [&](const char* part) { return rows_of(part) > 0; };  // beyond settling, whose checkpoint needs no record
        const Outcome stopped =
            child.ended_when([&] { return begun("out/records/case-000000.h5.part") && begun("out/records/case-000001.h5.part"); }, SIGHUP);
        ASSERT_EQ(stopped.status, 130);
        EXPECT_THAT(stopped.out, HasSubstr("to continue: cvtflow resume out\n"));
        for (const char* file : {"case-000000.h5", "case-000001.h5"}) ASSERT_TRUE(exists(std::string("out/checkpoints/") + file));
    }

    void change_a_byte(const std::string& name) const {
        std::string bytes = read(name);
        bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
        std::filesystem::remove(folder_ / name);
        write(name, bytes);
    }

    /// @return output of the rest of the sweep
    [[nodiscard]] std::string same_results() const {
        const Outcome rest = run({"resume", "out"});
        EXPECT_EQ(rest.status, 0) << rest.err;
        EXPECT_EQ(hash_in(rest.out), table("whole").attribute("results_hash"));
        EXPECT_FALSE(exists("out/checkpoints"));
        for (const auto& file : std::filesystem::directory_iterator(folder_ / "out" / "records"))
            EXPECT_EQ(file.path().extension(), ".h5") << "left behind: " << file.path();
        EXPECT_EQ(record("out/records/case-000000.h5").times(), record("whole/records/case-000000.h5").times());
        EXPECT_EQ(recorded_hash(folder_ / "out/records/case-000000.h5"), recorded_hash(folder_ / "whole/records/case-000000.h5"));
        return rest.err;
    }
};

TEST_F(StoppedSweep, ContinuesBitForBit) { EXPECT_THAT(same_results(), Not(HasSubstr("restarts"))); }

TEST_F(StoppedSweep, BeginsACaseAnewWhoseCheckpointIsDamaged) {
    change_a_byte("out/checkpoints/case-000000.h5");
    const std::string said = same_results();
    EXPECT_THAT(said, HasSubstr("cvtflow: case 0 restarts: its checkpoint cannot be used: out/checkpoints/case-000000.h5: damaged"));
    EXPECT_EQ(said.find("case 1 begins anew"), std::string::npos);
}

TEST_F(StoppedSweep, BeginsACaseAnewWhoseCheckpointIsThatOfAnother) {
    std::filesystem::copy_file(folder_ / "out/checkpoints/case-000001.h5", folder_ / "out/checkpoints/case-000000.h5",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_THAT(same_results(), HasSubstr("case 0 restarts: its checkpoint cannot be used: out/checkpoints/case-000000.h5: not a "
                                          "checkpoint of this scene:\n  clamping.driven = "));
}

TEST_F(StoppedSweep, BeginsACaseAnewWhoseRecordIsGone) {
    for (const char* name : {"case-000000.h5.part", "case-000000.h5"}) std::filesystem::remove(folder_ / "out/records" / name);
    EXPECT_THAT(same_results(), HasSubstr("case 0 restarts: its checkpoint cannot be used: out/records/case-000000.h5: the checkpoint's "
                                          "record does not exist"));
}

/// Cases start from each other's ends, which are kept, while rows may be lost with the power: behind the last row a strand continues, but
/// one with a gap, or without an end, begins anew.
TEST_F(Sweeps, ThatHasLostRowsOfCasesWhichOthersStartedFromRunsThemAllAgain) {
    write_sweep("\"6 N*m\"", "0.4 ms", "continuation = \"clamping.driven\"\ncheck = 0\n");
    const Outcome whole = run({"batch", "sweep.toml", "-o", "whole"});
    Child child({"batch", "sweep.toml", "-o", "stopped", "--grace", "1 us", "--checkpoint-every", "10 ms", "-q"}, folder_);
    ASSERT_EQ(child.ended_when([&] { return exists("stopped/checkpoints/case-000003.h5"); }, SIGTERM).status, 130);
    const engine::CaseTable rows = table("stopped");
    ASSERT_EQ(rows.size(), 3u);
    struct Lost {
        std::vector<std::size_t> left;
        const char *end, *now;
    };
    for (const auto& [left, end, now] :
         {Lost{{0}, "", "3 now"}, {{0, 2}, "", "4 now"}, {{0, 1, 2}, "", "1 now"}, {{0}, "end-000000.h5", "4 now"}}) {
        std::filesystem::remove_all(folder_ / "out");
        std::filesystem::copy(folder_ / "stopped", folder_ / "out", std::filesystem::copy_options::recursive);
        if (*end != 0) std::filesystem::remove(folder_ / "out/continuation" / end);
        engine::CaseTable some = rows;
        some.rows.clear();
        for (const std::size_t row : left) some.rows.insert(some.rows.end(), rows.row(row).begin(), rows.row(row).end());
        engine::write_cases({(folder_ / "out/cases.h5").string(), {.force = true}}, some);
        const Outcome rest = run({"resume", "out"});
        EXPECT_EQ(hash_in(rest.out), hash_in(whole.out)) << rest.err;
        EXPECT_EQ(column("start"), column("start", "whole"));
        EXPECT_THAT(rest.out, HasSubstr(now));
    }
}

TEST_F(Sweeps, ThatCannotWriteItsCheckpointsStopsAndBlamesNoCase) {
    write_sweep("\"6 N*m\"", "2 ms");
    std::filesystem::create_directory(folder_ / "out");
    write("out/checkpoints", "a file in the way");
    const Outcome outcome = batch({"--checkpoint-every", "1 ms", "-q"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, testing::StartsWith("cvtflow: out/checkpoints"));
    EXPECT_EQ(run({"table", "out", "--status", "bad_parameters", "--csv"}).out.find("bad_parameters"), std::string::npos);
}

/// A table of twelve rows as a power cut may leave it while it grows.
class TornSweep : public Sweeps {
protected:
    void SetUp() override {
        made_once("a damaged sweep", [this] { make(); });
        torn_ = read("out/cases.h5");
        torn_.replace(0, 48, 48, '\0');  // nor does HDF5 find the others
    }

    void make() const {
        write_sweep();
        const Outcome whole = run({"batch", "sweep.toml", "-o", "whole"});
        ASSERT_EQ(whole.status, 0) << whole.err;
        fs::copy(folder_ / "whole", folder_ / "out", fs::copy_options::recursive);
        std::string bytes = read("out/cases.h5");
        const auto hash = bytes.find(column("hash").at(5));
        ASSERT_NE(hash, std::string::npos);
        bytes[hash] = bytes[hash] == 'f' ? '0' : 'f';
        write("out/cases.h5", bytes);
        for (const char* command : {"resume", "table"}) {
            EXPECT_EQ(run({command, "out"}).err,
                      "cvtflow: out/cases.h5: damaged HDF5 file (changed after it was finished: its checksum differs)\n");
        }
        write("out/cases.h5", bytes.substr(0, bytes.size() - engine::seal_size));  // as a kill leaves it: each row has a check
    }

    [[nodiscard]] std::string whole_hash() const { return table("whole").attribute("results_hash"); }
    std::string torn_;
};

TEST_F(TornSweep, IsReadByNoOtherCommand) {
    const std::string before = read("out/cases.h5");
    EXPECT_EQ(run({"table", "out"}).err, "cvtflow: out/cases.h5: row 5 is damaged: its checksum differs\n");
    EXPECT_EQ(read("out/cases.h5"), before);
    write("out/cases.h5", before.substr(0, before.size() / 2));
    EXPECT_THAT(run({"resume", "out"}).err, testing::StartsWith("cvtflow: out/cases.h5: truncated HDF5 file: "));
}

TEST_F(TornSweep, ContinuesWithTheRowsThatAreWhole) {
    const Outcome outcome = run({"resume", "out"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, HasSubstr("cvtflow: out/cases.h5: row 5 is damaged: its checksum differs; "
                                       "intact rows are kept: 11; the other cases run again\n"));
    EXPECT_THAT(outcome.out, HasSubstr("1 now"));
    EXPECT_EQ(hash_in(outcome.out), whole_hash());
}

TEST_F(TornSweep, ContinuesWithThemWhereHdf5FindsNone) {
    write("out/cases.h5", torn_);
    const Outcome resumed = run({"resume", "out"});
    EXPECT_EQ(resumed.status, 1);
    EXPECT_EQ(resumed.err,
              "cvtflow: out/cases.h5: not an HDF5 file\n"
              "  to continue with the intact rows: cvtflow batch SWEEP -o out\n");
    EXPECT_EQ(read("out/cases.h5"), torn_);
    const Outcome outcome = batch();
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, HasSubstr("cvtflow: out/cases.h5: not an HDF5 file; intact rows are kept: 11; the other cases run again\n"));
    EXPECT_THAT(outcome.out, HasSubstr("1 now"));
    EXPECT_EQ(hash_in(outcome.out), whole_hash());
}

TEST_F(TornSweep, IsRefusedByAnotherSweepOrAnotherShard) {
    write("out/cases.h5", torn_);
    write_sweep("\"6 N*m\", \"12 N*m\", \"18 N*m\"", "50 us");
    EXPECT_EQ(batch().err, "cvtflow: out/cases.h5: not an HDF5 file\n");
    EXPECT_EQ(read("out/cases.h5"), torn_);
    write_sweep();
    std::filesystem::create_directories(folder_ / "out/workers/0001");
    write("out/workers/0001/cases.h5", torn_);
    EXPECT_EQ(batch({"--shard", "1/2"}).err, "cvtflow: out/workers/0001/cases.h5: not an HDF5 file\n");
    EXPECT_EQ(read("out/workers/0001/cases.h5"), torn_);
}

}  // namespace
}  // namespace cvtflow::tools
