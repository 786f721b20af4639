/// Files of a sweep are damaged before it continues: cases whose checkpoints cannot be used begin anew, with the same results.

#include <gmock/gmock.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

using testing::HasSubstr;

/// Processor time that the children of a process have taken so far [s].
double processor_time_of_children(pid_t parent) {
    double ticks = 0.0;
    std::error_code gone;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", gone)) {
        const std::string name = entry.path().filename().string();
        if (name.find_first_not_of("0123456789") != std::string::npos) continue;
        std::ifstream file(entry.path() / "stat");
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        if (text.rfind(')') == std::string::npos) continue;
        std::istringstream numbers(text.substr(text.rfind(')') + 1));
        std::string state, skipped;
        pid_t of = 0;
        numbers >> state >> of;
        for (int k = 0; k < 9; ++k) numbers >> skipped;  // up to majflt and cmajflt
        double user = 0.0, system = 0.0;
        if (of == parent && numbers >> user >> system) ticks += user + system;
    }
    return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

class DamagedSweep : public Sweeps {
protected:
    /// Two of four cases, side by side, are stopped with checkpoints and records in out; the whole sweep is in whole.
    void SetUp() override {
        write_sweep("\"6 N*m\"", "2.5 ms");
        std::string text = read("sweep.toml");
        write("sweep.toml", text.insert(text.find("[start]"), "records = true\n"));
        whole_ = run({"batch", "sweep.toml", "-o", "whole"});
        ASSERT_EQ(whole_.status, 0) << whole_.err;
        Child child({"batch", "sweep.toml", "-o", "out", "--threads", "2", "--grace", "1 us", "-q"}, folder_);
        ASSERT_TRUE(eventually([&] { return exists("out/records/case-000000.h5.part") && exists("out/records/case-000001.h5.part"); }));
        // Beyond settling: a checkpoint of settling needs no record.
        ASSERT_TRUE(eventually([&] { return processor_time_of_children(child.id()) > 0.2; }));
        child.send(SIGTERM);
        ASSERT_EQ(child.wait().status, 130);
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
        EXPECT_EQ(hash_in(rest.out), hash_in(whole_.out));
        EXPECT_FALSE(exists("out/checkpoints"));
        for (const auto& file : std::filesystem::directory_iterator(folder_ / "out" / "records"))
            EXPECT_EQ(file.path().extension(), ".h5") << "left behind: " << file.path();
        const engine::RunReader again((folder_ / "out/records/case-000000.h5").string()),
            whole((folder_ / "whole/records/case-000000.h5").string());
        EXPECT_EQ(again.times(), whole.times());
        EXPECT_EQ(recorded_hash(folder_ / "out/records/case-000000.h5"), recorded_hash(folder_ / "whole/records/case-000000.h5"));
        return rest.err;
    }

    Outcome whole_;
};

TEST_F(DamagedSweep, BeginsACaseAnewWhoseCheckpointIsDamaged) {
    change_a_byte("out/checkpoints/case-000000.h5");
    const std::string said = same_results();
    EXPECT_THAT(said, HasSubstr("cvtflow: case 0 restarts: its checkpoint cannot be used: out/checkpoints/case-000000.h5: damaged"));
    EXPECT_EQ(said.find("case 1 begins anew"), std::string::npos);
}

TEST_F(DamagedSweep, BeginsACaseAnewWhoseCheckpointIsThatOfAnother) {
    std::filesystem::copy_file(folder_ / "out/checkpoints/case-000001.h5", folder_ / "out/checkpoints/case-000000.h5",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_THAT(same_results(), HasSubstr("case 0 restarts: its checkpoint cannot be used: out/checkpoints/case-000000.h5: not a "
                                          "checkpoint of this scene:\n  clamping.driven = "));
}

TEST_F(DamagedSweep, BeginsACaseAnewWhoseRecordIsGone) {
    for (const char* name : {"case-000000.h5.part", "case-000000.h5"}) std::filesystem::remove(folder_ / "out/records" / name);
    EXPECT_THAT(same_results(), HasSubstr("case 0 restarts: its checkpoint cannot be used: out/records/case-000000.h5: the checkpoint's "
                                          "record does not exist"));
}

/// Cases start from each other's ends, of which the latest are kept, while rows may be lost with the power.
TEST_F(Sweeps, ThatHasLostRowsOfCasesWhichOthersStartedFromRunsThemAllAgain) {
    write_sweep("\"6 N*m\"", "1 ms", "continuation = \"clamping.driven\"\ncheck = 0\n");
    const Outcome whole = run({"batch", "sweep.toml", "-o", "whole"});
    Child child({"batch", "sweep.toml", "-o", "stopped", "--grace", "1 us", "--checkpoint-every", "10 ms", "-q"}, folder_);
    ASSERT_TRUE(eventually([&] { return exists("stopped/checkpoints/case-000003.h5"); }));
    child.send(SIGTERM);
    ASSERT_EQ(child.wait().status, 130);
    const engine::CaseTable rows = table("stopped");
    ASSERT_EQ(rows.size(), 3u);
    for (const std::vector<std::size_t>& left : {std::vector<std::size_t>{0}, {0, 2}, {0, 1, 2}}) {
        std::filesystem::remove_all(folder_ / "out");
        std::filesystem::copy(folder_ / "stopped", folder_ / "out", std::filesystem::copy_options::recursive);
        engine::CaseTable some = rows;
        some.rows.clear();
        for (const std::size_t row : left) some.rows.insert(some.rows.end(), rows.row(row).begin(), rows.row(row).end());
        engine::write_cases({(folder_ / "out/cases.h5").string(), {.force = true}}, some);
        const Outcome rest = run({"resume", "out"});
        EXPECT_EQ(hash_in(rest.out), hash_in(whole.out)) << rest.err;
        EXPECT_EQ(column("start"), column("start", "whole"));
        EXPECT_THAT(rest.out, HasSubstr(left.size() == 3 ? "1 now" : "4 now"));
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
        write_sweep();
        whole_ = batch();
        ASSERT_EQ(whole_.status, 0) << whole_.err;
        std::string bytes = read("out/cases.h5");
        const auto hash = bytes.find(column("hash").at(5));
        ASSERT_NE(hash, std::string::npos);
        bytes[hash] = bytes[hash] == 'f' ? '0' : 'f';
        bytes.resize(bytes.size() - engine::seal_size);
        write("out/cases.h5", bytes);  // one row is damaged
        bytes.replace(0, 48, 48, '\0');
        torn_ = bytes;  // nor does HDF5 find the others
    }

    Outcome whole_;
    std::string torn_;
};

TEST_F(TornSweep, ContinuesWithTheRowsThatAreWhole) {
    const Outcome outcome = run({"resume", "out"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_THAT(outcome.err, HasSubstr("cvtflow: out/cases.h5: row 5 is damaged: its checksum differs; "
                                       "intact rows are kept: 11; the other cases run again\n"));
    EXPECT_THAT(outcome.out, HasSubstr("1 now"));
    EXPECT_EQ(hash_in(outcome.out), hash_in(whole_.out));
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
    EXPECT_EQ(hash_in(outcome.out), hash_in(whole_.out));
}

TEST_F(TornSweep, IsRefusedByAnotherSweepOrAnotherShard) {
    write("out/cases.h5", torn_);
    write_sweep("\"6 N*m\", \"12 N*m\", \"18 N*m\"", "50 us");
    EXPECT_EQ(batch().err, "cvtflow: out/cases.h5: not an HDF5 file\n");
    EXPECT_EQ(read("out/cases.h5"), torn_);
    write_sweep();
    std::filesystem::create_directory(folder_ / "out/shard-0001-of-0002");
    write("out/shard-0001-of-0002/cases.h5", torn_);
    EXPECT_EQ(batch({"--shard", "1/2"}).err, "cvtflow: out/shard-0001-of-0002/cases.h5: not an HDF5 file\n");
    EXPECT_EQ(read("out/shard-0001-of-0002/cases.h5"), torn_);
}

}  // namespace
}  // namespace cvtflow::tools
