/// Files that killed and named runs leave, and what later runs keep of them.

#include <gmock/gmock.h>

#include "engine/record/run/run_reader.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tests/tools/output/replacement_fixture.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST_F(Replacement, MakesAPageAndAPictureOfTheSameSceneAgain) {
    for (int again = 0; again < 2; ++again) {
        EXPECT_EQ(run({"report", "own.h5", "-o", "t.html"}).status, 0);
        EXPECT_EQ(run({"plot", "own.h5", "slip", "-o", "t.svg"}).status, 0);
    }
    EXPECT_EQ(run({"report", "foreign.h5", "-o", "t.html"}).err,
              "cvtflow: t.html: already exists and is not a page that cvtflow made of 'other'; --force replaces it\n");
    EXPECT_EQ(run({"plot", "foreign.h5", "slip", "-o", "t.svg"}).status, 1);
    EXPECT_EQ(run({"report", "foreign.h5", "-o", "t.html", "--force"}).status, 0);
}

/// The rows of a killed run are the only copy of them.
TEST_F(Replacement, LeavesTheRowsOfAKilledRunToWhoAsksForThem) {
    fs::create_directory(folder_ / "results");
    fs::copy_file(folder_ / "own.h5", folder_ / "results/tiny.h5.part");
    const std::string rows = read("results/tiny.h5.part");
    const Outcome outcome = run(Words{"run", "tiny"} + brief_run);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err,
              "cvtflow: results/tiny.h5.part: already exists: rows of a run that was killed (cvtflow info shows them); --force replaces "
              "it\n");
    EXPECT_TRUE(read("results/tiny.h5.part") == rows);
    fs::copy_file(folder_ / "k.checkpoint.h5", folder_ / "results/tiny.checkpoint.h5");
    EXPECT_THAT(run(Words{"run", "tiny"} + brief_run).err, HasSubstr("cvtflow resume results/tiny.checkpoint.h5 continues it"));
    EXPECT_EQ(run(Words{"run", "tiny", "--force"} + brief_run).status, 0);
    EXPECT_FALSE(exists("results/tiny.h5.part"));
    EXPECT_FALSE(exists("results/tiny.checkpoint.h5"));
    EXPECT_EQ(run(Words{"run", "tiny"} + brief_run).status, 0);
}

/// M5: an archive with a checkpoint and a .part beside a record of that name.
TEST_F(Replacement, ResumeReplacesARecordOnlyIfItsRunWasToReplaceIt) {
    ASSERT_EQ(run({"resume", "k.checkpoint.h5", "-q", "-o", "none"}).status, 4);
    fs::rename(folder_ / "k.h5", folder_ / "k.h5.part");
    for (const char* there : {"foreign.h5", "own.h5", "notes.txt"}) {
        fs::copy_file(folder_ / there, folder_ / "k.h5");
        const std::string victim = read("k.h5");
        const Outcome outcome = run({"resume", "k.checkpoint.h5", "-q", "--set", "run.max_steps=0"});
        EXPECT_EQ(outcome.status, 1) << there;
        EXPECT_THAT(outcome.err, testing::StartsWith("cvtflow: k.h5: ")) << there;
        EXPECT_TRUE(read("k.h5") == victim) << there;
        EXPECT_TRUE(exists("k.h5.part")) << there;
        fs::remove(folder_ / "k.h5");
    }
    EXPECT_EQ(run({"resume", "k.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);
}

/// M6: the state of a checkpoint is in no finished record.
TEST_F(Replacement, KeepsACheckpointWhoseRunCanStillContinue) {
    const std::string checkpoint = read("k.checkpoint.h5");
    const double time = tasks::read_checkpoint((folder_ / "k.checkpoint.h5").string()).integration.time;
    ASSERT_GT(time, 1e-6);
    const Outcome early = run({"resume", "k.checkpoint.h5", "-q", "--set", "run.max_steps=0", "--until", "1 us"});
    EXPECT_EQ(early.status, 1);
    EXPECT_THAT(early.err, HasSubstr("is before the checkpoint"));
    EXPECT_TRUE(read("k.checkpoint.h5") == checkpoint);
    EXPECT_EQ(run({"resume", "k.checkpoint.h5", "-q", "--set", "run.max_steps=0", "-o", "none"}).status, 0);
    EXPECT_TRUE(read("k.checkpoint.h5") == checkpoint);
    EXPECT_EQ(run({"resume", "k.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);
    EXPECT_FALSE(exists("k.checkpoint.h5"));
}

/// L12
TEST_F(Replacement, GivesNamesWithDotsSideFilesOfTheirOwn) {
    for (const char* name : {"run_0.1", "run_0.2"}) {
        ASSERT_EQ(run(Words{"run", "tiny", "-o", name, "--checkpoint-every", "1 h", "--set", "run.max_steps=500"} + brief_run).status, 4);
        ASSERT_EQ(run({"report", name}).status, 0);
        ASSERT_EQ(run({"plot", name, "slip"}).status, 0);
        for (const char* ending : {".checkpoint.h5", ".html", ".svg"}) EXPECT_TRUE(exists(name + std::string(ending))) << name << ending;
    }
    EXPECT_EQ(run({"resume", "run_0.1.checkpoint.h5", "-q", "--set", "run.max_steps=0"}).status, 0);
    EXPECT_TRUE(exists("run_0.2.checkpoint.h5"));
}

/// L8
TEST_F(Replacement, RemovesOnlyTheSeriesOfItsOwnNameFromAFolderOfPictures) {
    fs::create_directory(folder_ / "t");
    write("t/mine.vtu", "mine");
    write("t/t_notes.vtu", "mine");
    write("t/t_000099.vtu", "of a former series");
    EXPECT_EQ(run({"export", "own.h5", "--vtk", "t.pvd"}).status, 1);
    EXPECT_EQ(run({"export", "own.h5", "--vtk", "t.pvd", "--force"}).status, 0);
    EXPECT_EQ(read("t/mine.vtu") + read("t/t_notes.vtu"), "minemine");
    EXPECT_FALSE(exists("t/t_000099.vtu"));
    EXPECT_TRUE(exists("t/t_000000.vtu"));
}

/// H6
TEST_F(Replacement, ReadsNoNameThatIsAPath) {
    const std::vector<std::string> bad{
        "../../x", "/tmp/x", "a\\\\b", "..", ".x", "a\\u001b[2J", "a\\u0001", "a\\uFFFE", std::string(201, 'x')};
    for (const std::string& name : bad) {
        write("named.toml", "[scene]\nname = \"" + name + "\"\n");
        for (const char* command : {"check", "export-fmu"}) {
            const Outcome outcome = run({command, "named.toml"});
            EXPECT_EQ(outcome.status, 1) << command << " " << name;
            EXPECT_THAT(outcome.err, HasSubstr("named.toml:2:")) << name;
            EXPECT_THAT(outcome.err, HasSubstr("scene.name: ")) << name;
            EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos);
        }
        std::string text = read("sweep.toml");
        write("named_sweep.toml", text.insert(text.find("scene ="), "name = \"" + name + "\"\n"));
        EXPECT_THAT(run({"batch", "named_sweep.toml", "--dry-run"}).err, HasSubstr("sweep.name: ")) << name;
    }
    write("named.toml", "[scene]\ndescription = \"a\\u0001b\"\n");
    EXPECT_THAT(run({"check", "named.toml"}).err, HasSubstr("scene.description: contains a control character"));
    EXPECT_EQ(run({"export-fmu", "tiny", "-q", "--author", "a\x01", "-o", "t.fmu"}).status, 2);
    write("a\x1b[2J.toml", read(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml"));
    const Outcome shown = run({"check", "a\x1b[2J.toml"});
    EXPECT_EQ((shown.out + shown.err).find('\x1b'), std::string::npos) << "a file's name may contain anything";
}

}  // namespace
}  // namespace cvtflow::tools
