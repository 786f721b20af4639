/// A sweep in a folder where files of the user lie.

#include <gmock/gmock.h>

#include <csignal>
#include <map>
#include <random>

#include "tests/tools/output/replacement_fixture.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// H3, H4, and kills: files of the user's lie where a sweep writes.
class SweepBesideFiles : public Replacement {
protected:
    std::map<std::string, std::string> mine_;

    void put_own_files() {
        for (const char* name : {"notes.txt", "checkpoints/mine.checkpoint.h5", "checkpoints/old/case-000000.h5", "continuation/notes.md",
                                 "records/mine.h5", "records/case-7.h5", "states/readme", "bench/main.cpp", "bench/src/main.cpp"}) {
            fs::create_directories((folder_ / "out" / name).parent_path());
            write(std::string("out/") + name, std::string("mine: ") + name);
        }
        fs::copy_file(folder_ / "foreign.h5", folder_ / "out/checkpoints/foreign.h5");
        for (const auto& [name, contents] : files()) {
            if (name.starts_with("out")) mine_[name] = contents;
        }
    }

    void kill_often(int kills, unsigned seed) {
        write_sweep("\"6 N*m\", \"9 N*m\", \"12 N*m\"", "80 us");
        std::string text = read("sweep.toml");
        write("sweep.toml", text.insert(text.find("[start]"), "records = true\n"));
        std::mt19937 moments(seed);
        for (int kill = 0; kill < kills; ++kill) {
            Child child({"batch", "sweep.toml", "-o", "out", "--checkpoint-every", "5 ms", "-q"}, folder_);
            std::this_thread::sleep_for(std::chrono::microseconds(5000 + moments() % 250000));
            child.send(SIGKILL);
            const Outcome outcome = child.wait();
            ASSERT_TRUE(outcome.status == 128 + SIGKILL || outcome.status == 0) << kill << ": " << outcome.err;
            expect_kept(mine_, "kill " + std::to_string(kill));
        }
        EXPECT_EQ(run({"batch", "sweep.toml", "-o", "out", "-q"}).status, 0);
        expect_kept(mine_, "the end");
        EXPECT_FALSE(exists("out/checkpoints/case-000000.h5"));
        EXPECT_EQ(column("status").size(), 12u);
        for (int number = 0; number < 12; ++number)
            EXPECT_TRUE(exists("out/records/case-0000" + std::string(number < 10 ? "0" : "") + std::to_string(number) + ".h5"));
    }
};

TEST_F(SweepBesideFiles, ChangesNoneOfThem) {
    put_own_files();
    EXPECT_EQ(run({"batch", "recorded.toml", "-q", "-o", "out"}).status, 0);
    expect_kept(mine_, "batch");
}

TEST_F(SweepBesideFiles, KilledTenTimesChangesNoneOfThem) {
    put_own_files();
    kill_often(10, 3);
}

using NightlySweepBesideFiles = SweepBesideFiles;

TEST_F(NightlySweepBesideFiles, KilledAHundredTimesChangesNoneOfThem) {
    put_own_files();
    kill_often(100, 4);
}

TEST_F(Replacement, MergeKeepsRowsThatTheShardsDoNotHave) {
    ASSERT_EQ(run({"merge", "cut"}).status, 0);
    fs::remove(folder_ / "cut/shard-0002-of-0002/cases.h5");
    const std::string whole = read("cut/cases.h5");
    const Outcome outcome = run({"merge", "cut", "--partial"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("cut/cases.h5: has 4 cases, the shards have"));
    EXPECT_TRUE(read("cut/cases.h5") == whole);
}

}  // namespace
}  // namespace cvtflow::tools
