/// The rule for files (engine/record/run/output_rule.hpp): what commands write where files of the user lie.

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <csignal>
#include <filesystem>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <string>

#include "engine/base/hash.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Files of every kind, to be put where commands write.

/// Options of a run and of settling that take a moment.
const Words brief_run{"-q", "--until", "40 us", "--step", "50 ns", "--set", "start.settling_time=20us", "--set", "start.ramp_time=10us"};
const Words brief_settle{"settle", "tiny", "-q", "--time", "20us", "--set", "start.ramp_time=10us"};

class Replacement : public Sweeps {
protected:
    /// Has own.h5 and foreign.h5 (records of tiny and of another scene), own's page.html and picture.svg, state.h5, k.h5 with its
    /// checkpoint, first/ (a finished sweep), cut/ (the shards of another, which is sweep.toml and, with records, recorded.toml),
    /// scene.toml, numbers.csv, notes.txt.
    Replacement() {
        made_once("files of every kind", [this] { make(); });
    }

    /// Original of which each kind is a copy; empty: it is made.
    static const std::map<std::string, std::string>& kinds();
    /// Puts a file of a kind at the target, or at its .part.
    void put(const std::string& kind, const std::string& target) const;
    /// Everything below the test's folder: its type and a hash of its contents, by name.
    [[nodiscard]] std::map<std::string, std::string> files() const;
    /// No file is missing or changed.
    void expect_kept(const std::map<std::string, std::string>& before, const std::string& what) const;
    /// Removes new files.
    void forget_new(const std::map<std::string, std::string>& before) const;

private:
    void make() const;
};

void Replacement::make() const {
    write_sweep("\"6 N*m\"", "20 us");
    write("scene.toml",
          "[chain]\npins = 24\npitch = \"16.6 mm\"\n[plate]\ncount = 4\n[pulley]\ncentre_distance = \"100 mm\"\n[detail]\nplates = "
          "\"lumped\"\njoint_points = 1\npulleys = \"rigid\"\n[start]\nsettling_time = \"20 us\"\nramp_time = \"10 us\"\n[run]\nuntil = "
          "\"20 us\"\n");
    write("numbers.csv", "time [s],load [N*m]\n0,1\n1,2\n");
    write("notes.txt", "mine\n");
    EXPECT_EQ(run(Words{"run", "tiny", "-o", "own.h5"} + brief_run).status, 0);
    EXPECT_EQ(run(Words{"run", "tiny", "-o", "foreign.h5", "--set", "scene.name=other"} + brief_run).status, 0);
    EXPECT_EQ(run({"report", "own.h5", "-o", "page.html"}).status, 0);
    EXPECT_EQ(run({"plot", "own.h5", "slip", "-o", "picture.svg"}).status, 0);
    EXPECT_EQ(run(brief_settle + Words{"-o", "state.h5"}).status, 0);
    EXPECT_EQ(run(Words{"run", "tiny", "-o", "k.h5", "--checkpoint-every", "1 h", "--set", "run.max_steps=500"} + brief_run).status, 4);
    EXPECT_EQ(run({"batch", "sweep.toml", "-q", "-o", "first"}).status, 0);
    write_sweep("\"7 N*m\"", "20 us");
    for (const char* shard : {"1/2", "2/2"}) EXPECT_EQ(run({"batch", "sweep.toml", "-q", "-o", "cut", "--shard", shard}).status, 0);
    const std::string plain = read("sweep.toml");
    add_records();
    fs::rename(folder_ / "sweep.toml", folder_ / "recorded.toml");
    write("sweep.toml", plain);
}

const std::map<std::string, std::string>& Replacement::kinds() {
    static const std::map<std::string, std::string> copies{{"own record", "own.h5"},
                                                           {"foreign record", "foreign.h5"},
                                                           {"page", "page.html"},
                                                           {"picture", "picture.svg"},
                                                           {"state", "state.h5"},
                                                           {"checkpoint", "k.checkpoint.h5"},
                                                           {"table", "first/cases.h5"},
                                                           {"scene", "scene.toml"},
                                                           {"CSV", "numbers.csv"},
                                                           {"text", "notes.txt"},
                                                           {"read-only", "notes.txt"},
                                                           {"own .part", "own.h5"},
                                                           {"foreign .part", "foreign.h5"},
                                                           {"link", ""},
                                                           {"link .part", ""},
                                                           {"FIFO", ""},
                                                           {"folder", ""}};
    return copies;
}

void Replacement::put(const std::string& kind, const std::string& target) const {
    const fs::path path = folder_ / (target + (kind.ends_with(".part") ? ".part" : ""));
    fs::create_directories(path.parent_path());
    if (kind == "link") fs::create_symlink(folder_ / "notes.txt", path);
    if (kind == "link .part") fs::create_symlink(folder_ / "nowhere", path);
    if (kind == "FIFO") mkfifo(path.c_str(), 0600);
    if (kind == "folder") fs::create_directory(path);
    if (!kinds().at(kind).empty()) fs::copy_file(folder_ / kinds().at(kind), path);
    if (kind == "read-only") fs::permissions(path, fs::perms::owner_read);
}

std::map<std::string, std::string> Replacement::files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
        const fs::file_status status = entry.symlink_status();
        std::string what = std::to_string(static_cast<int>(status.type()));
        if (fs::is_regular_file(status))
            what += " " + engine::Hash().add(std::string_view(read(entry.path().lexically_relative(folder_)))).hex();
        if (fs::is_symlink(status)) what += " " + fs::read_symlink(entry).string();
        all[entry.path().lexically_relative(folder_)] = what;
    }
    return all;
}

void Replacement::expect_kept(const std::map<std::string, std::string>& before, const std::string& what) const {
    const auto after = files();
    for (const auto& [name, contents] : before) {
        const auto there = after.find(name);
        ASSERT_TRUE(there != after.end()) << what << ": " << name << " is gone";
        EXPECT_EQ(there->second, contents) << what << ": " << name << " has changed";
    }
}

void Replacement::forget_new(const std::map<std::string, std::string>& before) const {
    const std::vector<fs::directory_entry> all(fs::recursive_directory_iterator(folder_), {});
    for (const auto& entry : all) {
        if (!before.contains(entry.path().lexically_relative(folder_))) fs::remove_all(entry.path());
    }
}

// The rule for files (engine/record/run/output_rule.hpp), of every command that writes, against every kind of file that may be there.

/// A command, and the file that it would write.
struct Writer {
    std::string name;
    Words words;
    std::string target;
    std::set<std::string> replaces{};  ///< kinds that are of the same kind and run
};

class EveryWriter : public Replacement {
protected:
    static std::vector<Writer> writers();
    void try_over(const std::string& kind, const Writer& writer) const;
};

std::vector<Writer> EveryWriter::writers() {
    const Words tune{"tune", "tiny", "-q", "--accuracy", "5 %", "--outputs", "slip", "--budget", "1 s", "--write", "t.toml"};
    return {
        {"run -o", Words{"run", "tiny", "-o", "t.h5"} + brief_run, "t.h5"},
        {"run", Words{"run", "tiny"} + brief_run, "results/tiny.h5", {"own record"}},
        {"run --checkpoint", Words{"run", "tiny", "-o", "t.h5", "--checkpoint-every", "1 us", "--checkpoint", "c.h5"} + brief_run, "c.h5"},
        {"settle -o", brief_settle + Words{"-o", "t.h5"}, "t.h5"},
        {"settle", brief_settle, "tiny_state.h5", {"state"}},
        {"resume -o", {"resume", "k.checkpoint.h5", "-q", "-o", "t.h5"}, "t.h5"},
        {"report -o", {"report", "own.h5", "-o", "t.html"}, "t.html", {"page"}},
        {"report", {"report", "own.h5"}, "own.html", {"page"}},
        {"report of a sweep", {"report", "first"}, "first/report.html"},
        {"plot -o", {"plot", "own.h5", "slip", "-o", "t.svg"}, "t.svg", {"picture"}},
        {"plot", {"plot", "own.h5", "slip"}, "own.svg", {"picture"}},
        {"plot of CSV", {"plot", "own.h5", "slip", "-o", "t.csv"}, "t.csv"},
        {"export --csv", {"export", "own.h5", "--csv", "t.csv"}, "t.csv"},
        {"export --vtk", {"export", "own.h5", "--vtk", "t.pvd"}, "t.pvd"},
        {"export --vtk, states", {"export", "own.h5", "--vtk", "t.pvd"}, "t/t_000000.vtu"},
        {"export-fmu -o", Words{"export-fmu", "tiny", "-q", "-o", "t.fmu"}, "t.fmu"},
        {"export-fmu", Words{"export-fmu", "tiny", "-q"}, "tiny.fmu"},
        {"batch", {"batch", "sweep.toml", "-q", "-o", "out"}, "out/cases.h5"},
        {"batch, records", {"batch", "recorded.toml", "-q", "-o", "out", "--threads", "1"}, "out/records/case-000000.h5"},
        {"batch, checkpoints",
         {"batch", "sweep.toml", "-q", "-o", "out", "--checkpoint-every", "1 us", "--threads", "1"},
         "out/checkpoints/case-000000.h5"},
        {"merge", {"merge", "cut"}, "cut/cases.h5"},
        {"tune --write", tune, "t.toml"},
        {"tune --write, state", tune, "t.h5", {"state"}},
        {"tune --write, picture", tune, "t.svg", {"picture"}},
    };
}

void EveryWriter::try_over(const std::string& kind, const Writer& writer) const {
    put(kind, writer.target);
    auto before = files();
    const Outcome outcome = Child(writer.words, folder_, {}, 100).wait();  // SIGALRM would end one that waits for the FIFO's reader
    const std::string what = writer.name + " over " + kind;
    if (writer.replaces.contains(kind)) {
        EXPECT_TRUE(outcome.status == 0 || (outcome.status == 4 && writer.words.front() == "tune")) << what << ": " << outcome.err;
        before.erase(writer.target);
    } else if (!writer.name.starts_with("batch, checkpoints")) {  // which may not need to write one
        EXPECT_EQ(outcome.status, 1) << what << ": " << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(writer.target)) << what;
        const bool continues = writer.name == "batch" || writer.name == "export --vtk, states";  // and so refuses what is not theirs first
        EXPECT_THAT(outcome.err,
                    HasSubstr(kind == "link .part" || (kind == "link" && !continues) ? ": a symbolic link; name its target" : ": "))
            << what;
    }
    if (writer.name.starts_with("batch, checkpoints") && (kind == "state" || kind == "checkpoint")) {
        before.erase(writer.target);  // a state of that name, in that folder, is the sweep's
        before.erase("out/checkpoints");
    }
    expect_kept(before, what);
    EXPECT_FALSE(exists("nowhere")) << what;
}

/// Every command over every kind of file; quick: every command over two kinds and those that it replaces, every kind under some commands.
TEST_F(EveryWriter, LosesNoFileThatIsNotOfTheSameKindAndRun) {
    const auto nothing = files();
    const std::vector<Writer> all = writers();
    const std::size_t each = cvtflow::test::depth<std::size_t>(9, 1);
    std::set<std::string> tried;
    int pairs = 0;
    for (std::size_t row = 0; row < all.size(); ++row) {
        std::size_t column = row;
        for (const auto& [kind, copy] : kinds()) {
            if (column++ % each != 0 && !all[row].replaces.contains(kind)) continue;
            try_over(kind, all[row]);
            forget_new(nothing);
            tried.insert(kind);
            ++pairs;
        }
    }
    std::cout << pairs << " pairs of a command and a file that was there; none was lost\n";
    EXPECT_EQ(tried.size(), kinds().size());
}

#ifdef CVTFLOW_FAULTS  // not under sanitizers, whose runtime has to be loaded before any other library
/// Every command, with a foreign file that takes the name while it works; not those that continue or create a file, nor slow tuning.
TEST_F(EveryWriter, LosesNoFileThatAppearsMeanwhile) {
    const auto nothing = files();
    for (const Writer& writer : writers()) {
        if (writer.name == "resume -o" || writer.name == "batch" || writer.name.starts_with("tune")) continue;
        const Outcome outcome = run(writer.words, {preload(CVTFLOW_FAULTS), "CVTFLOW_APPEARS=" + (folder_ / writer.target).string()});
        EXPECT_EQ(outcome.status, 1) << writer.name << ": " << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(writer.target + ": a")) << writer.name;
        const std::size_t part = outcome.err.find("meanwhile and it stays; the file of this one is ");
        EXPECT_TRUE(part == std::string::npos || exists(outcome.err.substr(part + 48, outcome.err.find('\n', part) - part - 48)));
        EXPECT_EQ(read(writer.target), "mine\n") << writer.name;
        expect_kept(nothing, writer.name);
        forget_new(nothing);
    }
}

TEST_F(Replacement, AFailedSeriesLeavesTheFormerOne) {
    ASSERT_EQ(run({"export", "own.h5", "--vtk", "t.pvd"}).status, 0);
    const auto before = files();
    for (const char* fault : {"CVTFLOW_FAULT=fsync:1", "CVTFLOW_FAULT=rename:1"}) {
        EXPECT_EQ(run({"export", "own.h5", "--vtk", "t.pvd", "--force"}, {preload(CVTFLOW_FAULTS), fault}).status, 1) << fault;
        EXPECT_EQ(files(), before) << fault;
    }
}
#endif

TEST_F(EveryWriter, ReplacesAnotherFileByForce) {
    const std::set<std::string> names{"run -o", "settle -o", "report -o", "plot -o", "export --csv", "export --vtk"};
    for (const Writer& writer : writers()) {
        if (!names.contains(writer.name)) continue;
        const auto nothing = files();
        put("text", writer.target);
        const Outcome outcome = run(writer.words + Words{"--force"});
        EXPECT_EQ(outcome.status, 0) << writer.name << ": " << outcome.err;
        EXPECT_NE(read(writer.target), "mine\n") << writer.name;
        forget_new(nothing);
    }
}

/// --force replaces other files, and no input under whatever name, nor what a run needs for itself.
TEST_F(Replacement, LosesNoInputByForce) {
    write("drive.csv", read(CVTFLOW_SOURCE_DIR "/scenes/drive.csv"));
    write("drive.toml", read(CVTFLOW_SOURCE_DIR "/scenes/drive.toml"));
    fs::create_hard_link(folder_ / "scene.toml", folder_ / "same.toml");
    fs::create_hard_link(folder_ / "state.h5", folder_ / "d.h5.part");
    fs::create_hard_link(folder_ / "notes.txt", folder_ / "b.h5.part");
    const Words by_state{"--set", "start.state=state.h5"}, scene{"run", "scene.toml", "-q"};
    const Words checkpoint = Words{"--checkpoint-every", "1 h", "-o", "r.h5", "--checkpoint"};
    const std::string input = ": cannot create: it would replace the input ", record = ": the run needs that name for its record r.h5";
    const std::vector<std::pair<Words, std::string>> commands{
        {scene + Words{"-o", "scene.toml"}, "scene.toml" + input + "scene.toml"},
        {scene + Words{"-o", "./same.toml"}, "./same.toml" + input + "scene.toml"},
        {{"settle", "scene.toml", "-q", "-o", "scene.toml"}, "scene.toml" + input + "scene.toml"},
        {scene + checkpoint + Words{"scene.toml"}, "scene.toml" + input + "scene.toml"},
        {scene + checkpoint + Words{"r.h5"}, "--checkpoint r.h5" + record},
        {scene + checkpoint + Words{"./r.h5.part"}, "--checkpoint ./r.h5.part" + record},
        {scene + Words{"-o", "b.h5"}, "b.h5.part: cannot create: File exists"},
        {scene + by_state + Words{"-o", "d.h5"}, "d.h5: cannot create: its .part would replace the input "},
        {Words{"run", "drive.toml", "-o", "drive.csv"} + brief_run, "drive.csv" + input},
        {Words{"run", "tiny", "-o", "state.h5"} + brief_run + by_state, "state.h5" + input},
        {Words{"settle", "tiny", "-o", "state.h5", "-q"} + by_state, "state.h5" + input},
        {{"resume", "k.checkpoint.h5", "-q", "-o", "k.checkpoint.h5"}, "k.checkpoint.h5" + input + "k.checkpoint.h5"},
        {Words{"export-fmu", "tiny", "-o", "state.h5", "-q"} + by_state, "state.h5" + input},
        {Words{"tune", "tiny", "-q", "--accuracy", "5 %", "--write", "state.toml"} + by_state, "state.h5" + input},
        {{"report", "own.h5", "-o", "own.h5"}, "own.h5" + input},
        {{"report", "first", "-o", "first/cases.h5"}, "first/cases.h5" + input},
        {{"export", "own.h5", "--csv", "own.h5"}, "own.h5" + input},
#ifdef CVTFLOW_LAB
        {{"profile", "scene.toml", "--trace", "scene.toml"}, "scene.toml" + input + "scene.toml"},
#endif
    };
    const auto before = files();
    for (const auto& [words, message] : commands) {
        const Outcome outcome = run(words.front() == "profile" ? words : words + Words{"--force"});  // which has no such option
        EXPECT_EQ(outcome.status, 1) << testing::PrintToString(words);
        EXPECT_THAT(outcome.err, HasSubstr(message)) << testing::PrintToString(words);
        EXPECT_EQ(files(), before) << testing::PrintToString(words);
    }
}

// Files that killed and named runs leave, and what later runs keep of them.

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
    EXPECT_THAT(run(Words{"run", "tiny"} + brief_run).err, HasSubstr(": the checkpoint of an unfinished run; cvtflow resume "
                                                                     "results/tiny.checkpoint.h5 continues it, --force starts again\n"));
    EXPECT_EQ(run(Words{"run", "tiny", "--force"} + brief_run).status, 0);
    EXPECT_FALSE(exists("results/tiny.h5.part"));
    EXPECT_FALSE(exists("results/tiny.checkpoint.h5"));
    EXPECT_EQ(run(Words{"run", "tiny"} + brief_run).status, 0);
}

/// M5: an archive with a checkpoint and a .part beside a record of that name.
TEST_F(Replacement, ResumeReplacesARecordOnlyIfItsRunWasToReplaceIt) {
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

TEST_F(Replacement, WaitsForNoPipeBesideItsFileAndDiscardsAPartWithoutContents) {
    mkfifo((folder_ / "t.h5.before").c_str(), 0600);
    write("own.html.part", std::string(5000, '\0'));  // a power cut
    EXPECT_EQ(Child(Words{"run", "tiny", "-o", "t.h5"} + brief_run, folder_, {}, 100).wait().status, 0);
    EXPECT_EQ(run({"report", "own.h5"}).status, 0);
    const Outcome resumed = Child({"resume", "k.checkpoint.h5", "-q", "-o", "t.h5", "--force"}, folder_, {}, 100).wait();
    EXPECT_THAT(resumed.err, HasSubstr("t.h5.before: cannot be continued: a device, pipe or socket, not a file"));
}

TEST_F(Replacement, WritesNoControlCharacterOfAName) {
    const std::string record = "\x1b[2Jx.h5";
    fs::copy_file(folder_ / "own.h5", folder_ / record);
    fs::rename(folder_ / "cut", folder_ / "\x1b[2Jcut");
    for (const Words& words : {Words{"info", record}, {"report", record}, {"plot", record, "slip"}, {"merge", "\x1b[2Jcut"}}) {
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 0) << words.front();
        EXPECT_THAT(outcome.out, HasSubstr("\\x1b[2J")) << words.front();
        EXPECT_EQ((outcome.out + outcome.err).find('\x1b'), std::string::npos) << words.front();
    }
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
TEST_F(Sweeps, AndScenesHaveNoNameThatIsAPath) {
    write_sweep();
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

// A sweep in a folder where files of the user lie.

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

    /// Kills (SIGKILL) a sweep at numbers of rows that are drawn, the first one before there is any, and compares it with an undisturbed
    /// one.
    void kill_often(int kills, unsigned seed) {
        put_own_files();
        write_sweep("\"6 N*m\", \"9 N*m\", \"12 N*m\"", "80 us");
        add_records();
        const Outcome whole = run({"batch", "sweep.toml", "-o", "whole"});
        std::mt19937 chance(seed);
        for (int kill = 0; kill < kills; ++kill) {
            const std::size_t rows = kill == 0 ? 0 : chance() % 12;
            Child child({"batch", "sweep.toml", "-o", "out", "--checkpoint-every", "5 ms", "-q"}, folder_);
            const Outcome outcome = child.ended_when([&] { return exists("out/cases.h5") && rows_of("out/cases.h5") >= rows; }, SIGKILL);
            ASSERT_TRUE(outcome.status == 128 + SIGKILL || outcome.status == 0) << kill << ": " << outcome.err;
            expect_kept(mine_, "kill " + std::to_string(kill));
        }
        const Outcome last = run({"resume", "out"});
        EXPECT_EQ(last.status, 0) << last.err;
        EXPECT_EQ(hash_in(last.out), hash_in(whole.out));
        for (const char* same : {"slip_mean", "evaluations"}) EXPECT_EQ(column(same), column(same, "whole"));
        expect_kept(mine_, "the end");
        EXPECT_FALSE(exists("out/checkpoints/case-000000.h5"));
        for (int number = 0; number < 12; ++number)
            EXPECT_TRUE(exists("out/records/case-0000" + std::string(number < 10 ? "0" : "") + std::to_string(number) + ".h5"));
    }
};

TEST_F(SweepBesideFiles, KilledChangesNoneOfThemAndLosesAndRepeatsNoCase) { kill_often(cvtflow::test::depth(2, 10), 3); }

using NightlySweepBesideFiles = SweepBesideFiles;

TEST_F(NightlySweepBesideFiles, KilledAHundredTimesChangesNoneOfThemAndLosesAndRepeatsNoCase) { kill_often(100, 4); }

TEST_F(Replacement, MergeKeepsRowsThatTheShardsDoNotHave) {
    ASSERT_EQ(run({"merge", "cut"}).status, 0);
    fs::remove(folder_ / "cut/workers/0002/cases.h5");
    const std::string whole = read("cut/cases.h5");
    const Outcome outcome = run({"merge", "cut", "--partial"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(outcome.err, HasSubstr("cut/cases.h5: has 4 cases, the workers have"));
    EXPECT_TRUE(read("cut/cases.h5") == whole);
}

}  // namespace
}  // namespace cvtflow::tools
