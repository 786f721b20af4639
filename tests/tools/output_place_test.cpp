/// Places where files go: folders with pipes and links in them, and systems that let nothing be written.

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>

#include "engine/base/text.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/tuning/tuned_scene.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/program/output.hpp"
#include "tools/program/text/report_columns.hpp"
#include "tools/program/text/tune_report.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

using OutputPlace = Program;

TEST_F(OutputPlace, ThatThisUserMustNotCreateIsNamedWithTheOptionForAnother) {
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    const uid_t user = geteuid();
    ASSERT_EQ(seteuid(user == 0 ? 65534 : user), 0);  // permissions hold for all but root
    EXPECT_THAT([] { (void)default_place("r.h5"); }, testing::ThrowsMessage<engine::RecordError>(HasSubstr(
                                                         "no permission to create the folder 'results' here (choose a place with -o)")));
    ASSERT_EQ(seteuid(user), 0);
    fs::current_path(before);
    fs::permissions(folder_, fs::perms::owner_all);
}

TEST_F(OutputPlace, OfEarlierCommandsNeedsNoFolderInTheNextOne) {
    ASSERT_EQ(run_briefly({}).status, 0);
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"info", "tiny.h5"}, {"plot", "tiny.h5", "slip"}, {"report", "tiny.h5"}}) {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << words.front() << ": " << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("tiny.h5: reading results/tiny.h5"));
    }
    fs::create_directory(folder_ / "results/slip");  // a channel is no folder
    EXPECT_EQ(run({"plot", "tiny.h5", "slip", "-o", "slip.svg"}).status, 0);
    write("tiny.h5", "");
    EXPECT_THAT(run({"info", "tiny.h5"}).err, Not(HasSubstr("results/")));
    EXPECT_THAT(run({"info", "absent.h5"}).err, HasSubstr("absent.h5: No such file or directory"));
}

/// Folders with pipes and links in them, and systems that let nothing be written.
class HostilePlace : public Sweeps {
protected:
    void link(const std::string& to, const std::string& name) const { std::filesystem::create_symlink(folder_ / to, folder_ / name); }
};

TEST_F(HostilePlace, ReportsALimitOfFileSizesAsAnError) {
    ASSERT_EQ(run_briefly({"-o", "good.h5"}).status, 0);
    ASSERT_EQ(run({"report", "good.h5"}).status, 0);
    const std::string before = read("good.html");
    const Outcome report = shell("ulimit -f 8; \"$CVTFLOW\" report good.h5");
    EXPECT_EQ(report.status, 1);
    EXPECT_THAT(report.err, HasSubstr("cannot write the request to Python: File too large"));
    EXPECT_TRUE(read("good.html") == before);
    EXPECT_FALSE(exists("good.html.part"));
    const Outcome run =
        shell("ulimit -f 8; \"$CVTFLOW\" run tiny -q -o big.h5 --until '40 us' --set start.settling_time=20us --set start.ramp_time=10us");
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.err, HasSubstr("File too large"));
}

TEST_F(HostilePlace, KeepsWhatIsWriteProtectedAndTheModeOfWhatItReplaces) {
    const fs::path record = folder_ / "results/tiny.h5";
    ASSERT_EQ(run_briefly().status, 0);
    fs::permissions(record, fs::perms::owner_read | fs::perms::owner_write);
    ASSERT_EQ(run_briefly().status, 0);
    EXPECT_EQ(fs::status(record).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    fs::permissions(record, fs::perms::owner_read);
    const std::string there = read("results/tiny.h5");
    EXPECT_EQ(run_briefly({"-q"}).err, "cvtflow: results/tiny.h5: already exists and is write-protected; --force replaces it\n");
    EXPECT_TRUE(read("results/tiny.h5") == there);
    EXPECT_EQ(run_briefly({"--force"}).status, 0);
}

TEST_F(HostilePlace, KnowsTheRecordOfAnotherFileWithTheSameName) {
    const std::string tiny = read(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    const Words brief = Words{"-q", "--until", "20 us", "--step", "50 ns"} + set_all({"start.settling_time=20us", "start.ramp_time=10us"});
    for (const char* folder : {"a", "b"}) {
        fs::create_directory(folder_ / folder);
        write(std::string(folder) + "/x.toml", tiny + "# of " + folder + "\n");
    }
    ASSERT_EQ(run(Words{"run", "a/x.toml"} + brief).status, 0);
    write("a/x.toml", tiny);
    EXPECT_EQ(run(Words{"run", "a/x.toml"} + brief).status, 0) << "the same file, edited";
    const Outcome other = run(Words{"run", "b/x.toml"} + brief);
    EXPECT_EQ(other.status, 1);
    EXPECT_THAT(other.err, HasSubstr("results/x.h5: already exists and is not a record of the scene 'tiny'; --force replaces it"));
}

TEST_F(HostilePlace, AppendsWhereTheShellAppends) {
    ASSERT_EQ(run_briefly({"-o", "own.h5"}).status, 0);
    ASSERT_EQ(shell("for k in 1 2; do \"$CVTFLOW\" export own.h5 slip --csv /dev/stdout >> all.csv; done").status, 0);
    ASSERT_EQ(run({"export", "own.h5", "slip", "--csv", "once.csv"}).status, 0);
    const std::string all = read("all.csv"), once = read("once.csv");
    const std::size_t second = all.find(once, 1);
    EXPECT_TRUE(all.starts_with(once) && second != std::string::npos) << all;
}

TEST_F(HostilePlace, ReportsThatStandardOutputIsClosed) {
    const Outcome outcome = shell("\"$CVTFLOW\" list scenes >&-");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.err, "cvtflow: standard output: cannot write: it is closed\n");
}

TEST_F(HostilePlace, PassesOverAPipeInTheTuningCache) {
    ASSERT_EQ(mkfifo((folder_ / "key.tuning").c_str(), 0600), 0);
    alarm(20);  // a reader that waits would be ended
    EXPECT_FALSE(tasks::read_tuning(folder_, "key").has_value());
    alarm(0);
}

TEST_F(HostilePlace, KeepsASweepInItsFolder) {
    write_sweep("\"6 N*m\"");
    std::filesystem::create_directories(folder_ / "out");
    std::filesystem::create_directories(folder_ / "elsewhere");
    for (const char* inside : {"records", "checkpoints", "continuation", "states"}) {
        link("elsewhere", std::string("out/") + inside);
        const Outcome outcome = batch();
        EXPECT_EQ(outcome.status, 1) << inside;
        EXPECT_THAT(outcome.err, HasSubstr(std::string("out/") + inside + ": a symbolic link; a sweep writes into real folders only"));
        std::filesystem::remove(folder_ / "out" / inside);
    }
    link("victim", "out/lock");  // dangling
    EXPECT_EQ(batch().status, 1);
    EXPECT_FALSE(exists("victim"));
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / "elsewhere"));
    std::filesystem::remove(folder_ / "out/lock");
    EXPECT_EQ(batch().status, 0);
}

TEST_F(HostilePlace, ReadsNoPipeAboveTheProgram) {
    std::filesystem::create_directories(folder_ / "a/b/c");
    std::filesystem::copy_file(CVTFLOW_PROGRAM, folder_ / "a/b/c/cvtflow");
    mkfifo((folder_ / "a/cvtflow-scenes.path").c_str(), 0600);
    EXPECT_EQ(shell("timeout 20 a/b/c/cvtflow list scenes").status, 0);
}

TEST(CsvCell, IsNoFormulaAndReadsBack) {
    EXPECT_EQ(tasks::csv_cell("=cmd|' /C calc'!A1", true), "'=cmd|' /C calc'!A1");
    for (const char* text : {"+1+1", "-1-1", "@SUM(A1)", "\tx"}) EXPECT_EQ(tasks::csv_cell(text, true).front(), '\'') << text;
    for (const char* number : {"-1.5", "3e-7", "-inf"}) EXPECT_EQ(tasks::csv_cell(number, true), number);
    EXPECT_EQ(tasks::csv_cell("-x", false), "-x");
    EXPECT_EQ(tasks::csv_cell("a,\"b\"", true), "\"a,\"\"b\"\"\"");
    EXPECT_EQ(tasks::csv_cell("\x1b[31m", true), "\\x1b[31m");
    EXPECT_EQ(tasks::csv_cell("a;=1+1 [m]", true), "\"a;=1+1 [m]\"");  // spreadsheets of other countries split there
    EXPECT_EQ(tasks::csv_lines(tasks::csv_cell("a,\"b\"\nc", true)).front(), std::vector<std::string>{"a,\"b\"\nc"});
}

/// Reports of tune and of the laboratory, too.
TEST(CsvCell, IsWrittenAlikeByReports) {
    EXPECT_EQ(csv_cell(nlohmann::ordered_json("requires detail.pins = \"halves\"")), "\"requires detail.pins = \"\"halves\"\"\"");
    EXPECT_EQ(csv_cell(nlohmann::ordered_json("=1+1")), "'=1+1");
    EXPECT_EQ(csv_cell(nlohmann::ordered_json(-1.5)), "-1.5");
    tasks::TuneResult result;
    result.outputs = {"slip"};
    result.choices.resize(1);
    result.choices[0].outcome = "requires detail.pins = \"halves\"";
    result.choices[0].worst = "=1+1";
    EXPECT_THAT(tune_csv(result), HasSubstr(",\"'=1+1\",0,\"requires detail.pins = \"\"halves\"\"\"\n"));
}

TEST(Visible, SpellsOutWhatATerminalWouldObey) {
    EXPECT_EQ(engine::visible("\x1b[2J"), "\\x1b[2J");
    EXPECT_EQ(engine::visible("a\nb\tc"), "a\nb\tc");
    EXPECT_EQ(engine::visible("\xc2\x9b"
                              "2J"),
              "\\xc2\\x9b2J");
    EXPECT_EQ(engine::visible("µ °C –"), "µ °C –");
    EXPECT_EQ(engine::visible(std::string_view("a\0b", 3)), "a\\x00b");
}

TEST_F(HostilePlace, CutsNoMessageAtANul) {
    write("nul.toml", "chain.\"pi\\u0000ns\" = 3\n");
    const Outcome outcome = run({"check", "nul.toml"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("pi\\x00ns: unknown key"));
}

}  // namespace
}  // namespace cvtflow::tools
