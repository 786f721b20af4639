/// Files of the user that -o must not change.

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputPlace : public Program {
protected:
    OutputPlace() {
        write("scene.toml", scene);
        write("notes.txt", "mine\n");
        mkfifo((folder_ / "pipe").c_str(), 0600);
        fs::create_symlink("notes.txt", folder_ / "link.h5");
    }
    [[nodiscard]] Outcome run_to(const std::vector<std::string>& more) const {
        std::vector<std::string> all{"run", "scene.toml", "-q"};
        all.insert(all.end(), more.begin(), more.end());
        return run(all);
    }
    void expect_refused(const Outcome& outcome, const std::string& message) const {
        EXPECT_EQ(outcome.status, 1);
        EXPECT_EQ(outcome.err, "cvtflow: " + message + "\n");
        EXPECT_EQ(read("scene.toml"), scene);
        EXPECT_EQ(read("notes.txt"), "mine\n");
        EXPECT_TRUE(fs::is_fifo(folder_ / "pipe"));
        EXPECT_TRUE(fs::is_symlink(folder_ / "link.h5"));
    }
    const std::string scene =
        "[chain]\npins = 24\npitch = \"16.6 mm\"\n[plate]\ncount = 4\n[pulley]\ncentre_distance = \"100 mm\"\n"
        "[detail]\norder = 0\nplates = \"lumped\"\njoint_points = 1\npulleys = \"rigid\"\n"
        "[start]\nsettling_time = \"20 us\"\nramp_time = \"10 us\"\n[run]\nuntil = \"20 us\"\n";
};

TEST_F(OutputPlace, OnlyPlainFilesAreReplaced) {
    for (const char* command : {"run", "settle"}) {
        expect_refused(run({command, "scene.toml", "-o", "pipe"}), "pipe: cannot create: a device, pipe or socket, not a file");
        expect_refused(run({command, "scene.toml", "-o", "link.h5"}), "link.h5: cannot create: a symbolic link; name its target");
    }
    expect_refused(run_to({"-o", "r.h5", "--checkpoint-every", "1 h", "--checkpoint", "pipe"}),
                   "pipe: cannot create: a device, pipe or socket, not a file");
    EXPECT_FALSE(exists("r.h5"));
}

TEST_F(OutputPlace, NoLinkIsFollowedWhereATemporaryFileGoes) {
    fs::create_symlink("notes.txt", folder_ / "a.h5.part");
    expect_refused(run_to({"-o", "a.h5"}), "a.h5.part: cannot create: a symbolic link; name its target");
    fs::create_hard_link(folder_ / "notes.txt", folder_ / "b.h5.part");
    expect_refused(run_to({"-o", "b.h5"}), "b.h5.part: already exists and is not a record of the scene 'scene'; --force replaces it");
    expect_refused(run_to({"-o", "b.h5", "--force"}), "b.h5.part: cannot create: File exists");
    fs::create_symlink("nowhere", folder_ / "c.h5.part");
    expect_refused(run({"settle", "scene.toml", "-o", "c.h5"}), "c.h5.part: cannot create: a symbolic link; name its target");
    EXPECT_FALSE(exists("nowhere"));
}

TEST_F(OutputPlace, NoInputIsReplacedUnderWhateverName) {
    fs::create_hard_link(folder_ / "scene.toml", folder_ / "same.toml");
    expect_refused(run_to({"-o", "scene.toml"}), "scene.toml: cannot create: it would replace the input scene.toml");
    expect_refused(run_to({"-o", "./same.toml"}), "./same.toml: cannot create: it would replace the input scene.toml");
    expect_refused(run({"settle", "scene.toml", "-o", "scene.toml"}), "scene.toml: cannot create: it would replace the input scene.toml");
    expect_refused(run_to({"-o", "none", "--checkpoint-every", "1 h", "--checkpoint", "scene.toml"}),
                   "scene.toml: cannot create: it would replace the input scene.toml");
    EXPECT_EQ(run({"profile", "scene.toml", "--csv", "scene.toml"}).err,
              "cvtflow-lab: scene.toml: cannot create: it would replace the input scene.toml\n");
    ASSERT_EQ(run({"settle", "scene.toml", "-q", "-o", "state.h5"}).status, 0);
    const std::string state = read("state.h5"), path = (folder_ / "state.h5").string();
    expect_refused(run_to({"--set", "start.state=state.h5", "-o", "state.h5"}),
                   "state.h5: cannot create: it would replace the input " + path);
    fs::create_hard_link(folder_ / "state.h5", folder_ / "d.h5.part");
    expect_refused(run_to({"--set", "start.state=state.h5", "-o", "d.h5"}),
                   "d.h5: cannot create: its .part would replace the input " + path);
    EXPECT_EQ(read("state.h5"), state);
}

TEST_F(OutputPlace, ACheckpointTakesTheNameOfNothingElseAndIsAllThatIsRemoved) {
    expect_refused(run_to({"-o", "r.h5", "--checkpoint-every", "1 h", "--checkpoint", "r.h5"}),
                   "--checkpoint r.h5: the run needs that name for its record r.h5");
    expect_refused(run_to({"-o", "r.h5", "--checkpoint-every", "1 h", "--checkpoint", "./r.h5.part"}),
                   "--checkpoint ./r.h5.part: the run needs that name for its record r.h5");
    const Outcome outcome = run_to({"-o", "r.h5", "--checkpoint-every", "1 h", "--checkpoint", "notes.txt"});
    expect_refused(outcome, "--checkpoint: the file exists and is not a checkpoint: notes.txt: not an HDF5 file");
}

TEST_F(OutputPlace, ResumeDoesNotWriteOverItsCheckpoint) {
    ASSERT_EQ(run_to({"-o", "r.h5", "--checkpoint-every", "1 h", "--set", "run.max_steps=5"}).status, 4);
    ASSERT_TRUE(exists("r.checkpoint.h5"));
    expect_refused(run({"resume", "r.checkpoint.h5", "-q", "-o", "r.checkpoint.h5"}),
                   "r.checkpoint.h5: cannot create: it would replace the input r.checkpoint.h5");
    EXPECT_EQ(run({"resume", "r.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);
}

}  // namespace
}  // namespace cvtflow::tools
