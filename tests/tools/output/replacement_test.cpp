/// The rule for files (engine/record/run/output_rule.hpp), of every command that writes, against every kind of file that may be there.

#include <gmock/gmock.h>

#include <iostream>
#include <set>

#include "tests/tools/output/replacement_fixture.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

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
    void try_all(const Writer& writer, int& pairs) const;
};

std::vector<Writer> EveryWriter::writers() {
    const Words tune{"tune", "tiny", "-q", "--accuracy", "5 %", "--outputs", "slip", "--budget", "1 s", "--write", "t.toml"};
    return {
        {"run -o", Words{"run", "tiny", "-o", "t.h5"} + brief_run, "t.h5"},
        {"run", Words{"run", "tiny"} + brief_run, "results/tiny.h5", {"own record"}},
        {"run --checkpoint", Words{"run", "tiny", "-o", "t.h5", "--checkpoint-every", "1 h", "--checkpoint", "c.h5"} + brief_run, "c.h5"},
        {"settle -o", brief_settle + Words{"-o", "t.h5"}, "t.h5"},
        {"settle", brief_settle, "tiny_state.h5", {"state"}},
        {"resume -o", {"resume", "k.checkpoint.h5", "-q", "-o", "t.h5"}, "t.h5"},
        {"report -o", {"report", "own.h5", "-o", "t.html"}, "t.html"},
        {"report", {"report", "own.h5"}, "own.html"},
        {"report of a sweep", {"report", "first"}, "first/report.html"},
        {"plot -o", {"plot", "own.h5", "slip", "-o", "t.svg"}, "t.svg"},
        {"plot", {"plot", "own.h5", "slip"}, "own.svg"},
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
        {"tune --write, picture", tune, "t.svg"},
    };
}

void EveryWriter::try_all(const Writer& writer, int& pairs) const {
    for (const auto& [kind, copy] : kinds()) {
        const auto nothing = files();
        const fs::path path = put(kind, writer.target);
        auto before = files();
        const Child child(writer.words, folder_, {}, 100);  // SIGALRM would end one that waits for the FIFO's reader
        const Outcome outcome = const_cast<Child&>(child).wait();
        const std::string what = writer.name + " over " + kind;
        if (writer.replaces.contains(kind)) {
            EXPECT_TRUE(outcome.status == 0 || (outcome.status == 4 && writer.words.front() == "tune")) << what << ": " << outcome.err;
            before.erase(writer.target);
        } else if (!writer.name.starts_with("batch, checkpoints")) {  // which may not need to write one
            EXPECT_EQ(outcome.status, 1) << what << ": " << outcome.err;
            EXPECT_THAT(outcome.err, HasSubstr(writer.target)) << what;
        }
        if (writer.name.starts_with("batch, checkpoints") && (kind == "state" || kind == "checkpoint")) {
            before.erase(writer.target);  // a state of that name, in that folder, is the sweep's
            before.erase("out/checkpoints");
        }
        expect_kept(before, what);
        forget_new(nothing);
        ++pairs;
    }
}

TEST_F(EveryWriter, LosesNoFileThatIsNotOfTheSameKindAndRun) {
    int pairs = 0;
    for (const Writer& writer : writers()) try_all(writer, pairs);
    std::cout << pairs << " pairs of a command and a file that was there; none was lost\n";
    EXPECT_EQ(static_cast<std::size_t>(pairs), writers().size() * 14);
}

/// --force replaces plain files, and no input under whatever name.
TEST_F(Replacement, LosesNoInputByForce) {
    write("drive.csv", read(CVTFLOW_SOURCE_DIR "/scenes/drive.csv"));
    write("drive.toml", read(CVTFLOW_SOURCE_DIR "/scenes/drive.toml"));
    const Words by_state{"--set", "start.state=state.h5"};
    const std::vector<Words> commands{
        Words{"run", "drive.toml", "-o", "drive.csv"} + brief_run,
        Words{"run", "tiny", "-o", "state.h5"} + brief_run + by_state,
        Words{"settle", "tiny", "-o", "state.h5", "-q"} + by_state,
        Words{"export-fmu", "tiny", "-o", "state.h5", "-q"} + by_state,
        Words{"tune", "tiny", "-q", "--accuracy", "5 %", "--write", "state.toml"} + by_state,
        {"report", "own.h5", "-o", "own.h5"},
        {"report", "first", "-o", "first/cases.h5"},
        {"export", "own.h5", "--csv", "own.h5"},
    };
    const auto before = files();
    for (Words words : commands) {
        words.emplace_back("--force");
        const Outcome outcome = run(words);
        EXPECT_EQ(outcome.status, 1) << testing::PrintToString(words);
        EXPECT_THAT(outcome.err, HasSubstr("would replace the input")) << testing::PrintToString(words);
        expect_kept(before, testing::PrintToString(words));
    }
}

}  // namespace
}  // namespace cvtflow::tools
