/// A task of a job array with node-local scratch (tools/slurm/array.sbatch --local), without Slurm.

#include <gmock/gmock.h>

#include "tests/tools/batch_fixture.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SlurmLocal : public Sweeps {
protected:
    SlurmLocal() {
        fs::create_directory(folder_ / "bin");
        for (const char* name : {"squeue", "scontrol"}) program(name, "#!/bin/sh\nexit 0\n");
        write_sweep("\"6 N*m\"", "20 us");
    }
    void program(const std::string& name, const std::string& text) const {
        write("bin/" + name, text);
        fs::permissions(folder_ / "bin" / name, fs::perms::owner_all);
    }
    /// The first of two tasks, with its shard in `dir`.
    [[nodiscard]] Outcome task(const std::string& dir = "dir", const std::string& sweep = "sweep.toml") const {
        write("task.sh", "PATH=" + (folder_ / "bin").string() + ":$PATH SLURM_ARRAY_TASK_ID=1 SLURM_ARRAY_JOB_ID=1 SWEEP=" + sweep +
                             " DIR=" + (folder_ / dir).string() + " SHARDS=2 TASKS=2 LOCAL=" + (folder_ / "local").string() +
                             " bash " CVTFLOW_SOURCE_DIR "/tools/slurm/array.sbatch\n");
        return shell("bash task.sh");
    }
    [[nodiscard]] std::string rows(const std::string& folder) const { return run({"table", folder, "--csv"}).out; }
    const std::string shard_ = "dir/shard-0001-of-0002";
};

TEST_F(SlurmLocal, BringsAShardBackAndLeavesNothingOnTheNode) {
    const Outcome done = task();
    ASSERT_EQ(done.status, 0) << done.out << done.err;
    EXPECT_FALSE(rows(shard_).empty());
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "local"))
        EXPECT_NE(entry.path().filename(), "cases.h5") << entry.path();
    const std::string table = rows(shard_);
    EXPECT_EQ(task().status, 0);
    EXPECT_EQ(rows(shard_), table) << "a finished shard runs no case again";
}

TEST_F(SlurmLocal, AFullScratchLosesNoFinishedShard) {
    ASSERT_EQ(task().status, 0);
    const std::string table = read(shard_ + "/cases.h5");
    program("cp",
            "#!/bin/sh\nfor last; do :; done\ncase \"$last\" in *local*) mkdir -p \"$last\"; : > \"$last/cases.h5\"; exit 1;; esac\nexec "
            "/bin/cp \"$@\"\n");
    const Outcome full = task();
    EXPECT_EQ(full.status, 1);
    EXPECT_THAT(full.out, HasSubstr("shard 1 of 2: cannot be copied to "));
    EXPECT_TRUE(read(shard_ + "/cases.h5") == table);
}

TEST_F(SlurmLocal, AFullSharedFolderKeepsTheFormerShardAndTheNewOne) {
    ASSERT_EQ(task().status, 0);
    const std::string table = read(shard_ + "/cases.h5");
    program("cp", "#!/bin/sh\nfor last; do :; done\ncase \"$last\" in *copying*) mkdir -p \"$last\"; exit 1;; esac\nexec /bin/cp \"$@\"\n");
    const Outcome full = task();
    EXPECT_EQ(full.status, 1);
    EXPECT_THAT(full.out, HasSubstr("cannot be copied back; its results are in "));
    EXPECT_TRUE(read(shard_ + "/cases.h5") == table);
}

TEST_F(SlurmLocal, TakesNothingOfAnotherSweepOnTheNode) {
    for (const char* folder : {"local", "local/other"}) {
        ASSERT_EQ(run({"batch", "sweep.toml", "-q", "-o", folder, "--shard", "1/2"}).status, 0);
    }
    const std::string first = read("sweep.toml");
    write_sweep("\"9 N*m\"", "20 us");
    const Outcome second = task();
    EXPECT_EQ(second.status, 0) << second.out << second.err;
    EXPECT_THAT(rows(shard_), HasSubstr(",9,"));
    EXPECT_EQ(rows(shard_).find(",6,"), std::string::npos);
}

TEST_F(SlurmLocal, FindsAShardThatAKillLeftBetweenTwoNames) {
    ASSERT_EQ(task().status, 0);
    const std::string table = rows(shard_);
    for (const char* name : {".new", ".old"}) {
        fs::rename(folder_ / shard_, folder_ / (shard_ + name));
        EXPECT_EQ(task().status, 0) << name;
        EXPECT_EQ(rows(shard_), table) << name << ": no case runs again, so that even wall times are the same";
        EXPECT_FALSE(exists(shard_ + name));
    }
}

TEST_F(SlurmLocal, GivesBackNothingOfASweepThatFailed) {
    ASSERT_EQ(task().status, 0);  // leaves task.sh
    const std::string table = read(shard_ + "/cases.h5");
    program("cvtflow",
            "#!/bin/sh\n[ \"$1\" = batch ] && { : > $4/shard-0001-of-0002/cases.h5; exit 1; }\nexec " CVTFLOW_PROGRAM " \"$@\"\n");
    const std::string script = "export CVTFLOW=" + (folder_ / "bin/cvtflow").string() + "; ";
    EXPECT_EQ(shell(script + "bash task.sh").status, 1);
    EXPECT_TRUE(read(shard_ + "/cases.h5") == table);
}

}  // namespace
}  // namespace cvtflow::tools
