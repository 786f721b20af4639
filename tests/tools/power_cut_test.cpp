/// Power cuts: unsynced data are lost, or part of them. A run or sweep resumes from the rest, and its results are bitwise those of an
/// undisturbed one; or a run reports clearly that it cannot resume. Only complete files have a final name.

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>

#include "engine/base/hash.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tasks/batch/results/sweep_files.hpp"
#include "tests/tools/batch_fixture.hpp"
#include "tests/tools/power_cut_fixture.hpp"

#ifdef CVTFLOW_POWER

namespace cvtflow::tools {
namespace {

class PowerCut : public Sweeps {
protected:
    PowerCut() { std::filesystem::create_directory(work_); }

    Outcome run_at_work(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {}) const {
        return Child(arguments, work_, environment).wait();
    }

    /// Runs to the end. @return everything that was done to files on the way
    [[nodiscard]] std::vector<Change> logged(const std::vector<std::string>& arguments) const {
        const Outcome outcome =
            run_at_work(arguments, {"LD_PRELOAD=" CVTFLOW_POWER, "CVTFLOW_POWER_LOG=" + (folder_ / "changes").string()});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return read_power_log(folder_ / "changes", work_);
    }

    /// Removes all files but those that were there before the program ran.
    void clear_work() const {
        const std::vector<std::filesystem::directory_entry> all(std::filesystem::directory_iterator(work_), {});
        for (const auto& entry : all) {
            if (entry.path().filename() != "sweep.toml") std::filesystem::remove_all(entry.path());
        }
    }

    /// Resumes after `cuts` cuts at random moments, every other one of each kind.
    /// @param resume  status 0 if the result is there and the same; else the message of the refusal
    template <class Resume>
    void cut_and_resume(const std::vector<Change>& changes, int cuts, const Resume& resume) {
        std::mt19937 chance(17);
        for (int cut = 0; cut < cuts; ++cut) {
            const std::size_t count = chance() % (changes.size() + 1);
            const Disk disk = cut % 2 == 0 ? Disk::dropped : Disk::journalled;
            clear_work();
            cut_power(changes, count, disk, work_, chance);
            SCOPED_TRACE("cut " + std::to_string(cut) + " after " + std::to_string(count) + " of " + std::to_string(changes.size()));
            const Outcome outcome = resume();
            same_ += outcome.status == 0;
            if (outcome.status == 0) continue;
            EXPECT_EQ(disk, Disk::journalled) << "refused what was synced: " << outcome.err;
            EXPECT_EQ(outcome.status, 1) << outcome.err;
            EXPECT_TRUE(outcome.err.starts_with("cvtflow: ")) << outcome.err;
            std::printf("refused: %s", outcome.err.c_str());
        }
        std::printf("%d power cuts: %d the same bits (%d of them continued from a checkpoint or table), %d refused\n", cuts, same_,
                    continued_, cuts - same_);
    }

    /// Writes the sweep and runs it with checkpoints. @return everything that was done to files on the way
    [[nodiscard]] std::vector<Change> logged_sweep() const;
    void single_run(int cuts);
    void sweep(int cuts);

    const std::filesystem::path work_ = folder_ / "work";
    int same_ = 0, continued_ = 0;
};

/// Contents of a record: rows, the last state, how the run ended.
std::string contents_of(const std::filesystem::path& record) {
    const engine::RunReader reader(record.string());
    engine::Hash hash;
    for (const engine::ChannelInfo& channel : reader.channels()) hash.add(std::span<const double>(reader.channel(channel.name)));
    hash.add(std::span<const double>(reader.times()));
    hash.add(std::span<const double>(reader.state(reader.state_times().size() - 1).state));
    return std::to_string(reader.rows()) + " " + hash.hex() + " " + reader.status();
}

void PowerCut::single_run(int cuts) {
    const std::vector<std::string> order = run_to_be_ended("run.h5");
    const std::vector<Change> changes = logged(order + std::vector<std::string>{"--checkpoint-every", "3 ms"});
    const std::string whole = contents_of(work_ / "run.h5");
    cut_and_resume(changes, cuts, [&] {
        Outcome outcome;
        if (std::filesystem::exists(work_ / "run.checkpoint.h5")) {
            outcome = run_at_work({"resume", "run.checkpoint.h5", "-q"});
            continued_ += outcome.status == 0;
        } else if (!std::filesystem::exists(work_ / "run.h5")) {
            outcome = run_at_work(order);
        }
        if (outcome.status == 0) {
            EXPECT_EQ(contents_of(work_ / "run.h5"), whole);
        }
        return outcome;
    });
}

const std::vector<std::string> sweep_order{"batch", "sweep.toml", "-o", "out"};

std::vector<Change> PowerCut::logged_sweep() const {
    write_sweep("\"6 N*m\", \"12 N*m\", \"18 N*m\"", "0.2 ms");
    std::filesystem::rename(folder_ / "sweep.toml", work_ / "sweep.toml");
    return logged(sweep_order + std::vector<std::string>{"--checkpoint-every", "5 ms", "--threads", "2"});
}

void PowerCut::sweep(int cuts) {
    const std::vector<Change> changes = logged_sweep();
    const std::string whole = hash_in(run_at_work(sweep_order).out);
    cut_and_resume(changes, cuts, [&] {
        const bool begun = std::filesystem::exists(work_ / "out" / "cases.h5");
        const Outcome outcome = run_at_work(sweep_order);
        if (outcome.status == 0) {
            EXPECT_EQ(hash_in(outcome.out), whole) << outcome.err;
        }
        continued_ += begun && outcome.status == 0;
        return outcome;
    });
    EXPECT_EQ(same_, cuts);  // rows of a torn table are found without HDF5
}

TEST_F(PowerCut, OfARunLeavesWhatLeadsToTheSameBits) {
    single_run(20);
    EXPECT_GE(continued_, 5);
}

TEST_F(PowerCut, OfASweepLeavesWhatLeadsToTheSameBits) {
    sweep(20);
    EXPECT_GE(continued_, 5);
}

/// Blocks of a new table reach the disk in any order. Few cuts of a whole sweep fall into this moment.
TEST_F(PowerCut, WhileATableIsCreatedLeavesWhatTheSweepMayReplace) {
    std::vector<Change> changes = logged_sweep();
    const std::string table = (work_ / "out" / "cases.h5").string(), part = table + ".part";
    const auto named = [&](const Change& change) { return change.what == "rename" && change.to == table; };
    changes.erase(std::find_if(changes.begin(), changes.end(), named), changes.end());
    const std::string definition = engine::CaseReader(table).head().attribute("definition");
    std::mt19937 chance(5);
    int torn = 0;
    for (int cut = 0; cut < 4000; ++cut) {
        clear_work();
        cut_power(changes, chance() % (changes.size() + 1), Disk::journalled, work_, chance);
        std::error_code absent;
        torn += std::filesystem::file_size(part, absent) > 0 && !absent;
        if (std::filesystem::is_directory(work_ / "out")) {
            EXPECT_NO_THROW((void)tasks::permit_table(table, definition)) << "cut " << cut;
        }
    }
    EXPECT_GE(torn, 200);
}

using NightlyPowerCut = PowerCut;

TEST_F(NightlyPowerCut, TwoHundredOfARun) { single_run(200); }
TEST_F(NightlyPowerCut, TwoHundredOfASweep) { sweep(200); }

}  // namespace
}  // namespace cvtflow::tools

#endif
