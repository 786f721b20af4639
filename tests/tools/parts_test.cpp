/// Parts of the program that a test can call or compare with the library's catalogues; whole commands: *_test.py.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "engine/base/text.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/run_recorder.hpp"
#include "tasks/scene/csv.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/tools/program_fixture.hpp"
#include "tools/program/output.hpp"
#include "tools/program/progress.hpp"
#include "tools/program/text/report_columns.hpp"

namespace cvtflow::tools {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

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

/// Reports of the laboratory, too.
TEST(CsvCell, IsWrittenAlikeByReports) {
    EXPECT_EQ(csv_cell(nlohmann::ordered_json("requires detail.pins = \"halves\"")), "\"requires detail.pins = \"\"halves\"\"\"");
    EXPECT_EQ(csv_cell(nlohmann::ordered_json("=1+1")), "'=1+1");
    EXPECT_EQ(csv_cell(nlohmann::ordered_json(-1.5)), "-1.5");
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

using ProgramParts = Program;

TEST_F(ProgramParts, APlaceThatThisUserMustNotCreateIsNamedWithTheOptionForAnother) {
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

TEST_F(ProgramParts, ListEveryRowOfTheCatalogues) {
    EXPECT_THAT(run({"list"}).out, AllOf(HasSubstr("\n  methods "), HasSubstr("\n  licenses ")));
    const std::string methods = run({"list", "methods", "--all"}).out, channels = run({"list", "channels"}).out,
                      keys = run({"list", "keys"}).out;
    EXPECT_THAT(methods, testing::ContainsRegex("\nrk4 +4 +4 +[a-z]")) << "stages and order";
    for (const engine::StagePlan& plan : engine::methods()) EXPECT_THAT(methods, HasSubstr("\n" + plan.name + " "));
    for (const tasks::Channel& channel : tasks::channels()) EXPECT_THAT(channels, HasSubstr("\n" + std::string(channel.name) + " "));
    for (const tasks::Parameter& parameter : tasks::parameter_table())
        EXPECT_THAT(keys, HasSubstr("\n" + std::string(parameter.key) + " "));
    const std::string detail = run({"list", "detail"}).out;
    for (const tasks::DetailPreset& preset : tasks::detail_presets()) EXPECT_THAT(detail, HasSubstr("\n" + std::string(preset.name) + " "));
    EXPECT_THAT(run({"list", "scenes"}).out, AllOf(HasSubstr("\nbaseline "), HasSubstr("\ntiny ")));
    EXPECT_THAT(run({"list", "executors", "units"}).out, AllOf(HasSubstr("\nserial "), HasSubstr("\na torque ")));
    EXPECT_THAT(run({"list", "terms"}).out, HasSubstr("\ncreep "));
}

TEST_F(ProgramParts, ListTheMethodsThatOneWouldUse) {
    std::istringstream list(run({"list", "methods"}).out);
    std::vector<std::string> names;
    for (std::string line; std::getline(list, line) && !line.empty();) names.push_back(line.substr(0, line.find(' ')));
    ASSERT_EQ(names.size(), 8u) << "a heading, a rule and six methods";
    EXPECT_EQ(names[2], tasks::Scene().run.method) << "the default is the first";
    for (std::size_t k = 3; k < names.size(); ++k) EXPECT_THAT(tasks::method_names(), testing::Contains(names[k]));
}

/// Beside what check states: attributes and one chunk of states, 0.4 MB. Chunks of 512 rows took 2 MB more.
TEST_F(ProgramParts, ARecordTakesTheRoomThatCheckStates) {
    const std::vector<std::string> settings{"start.settling_time=1 ms", "start.ramp_time=0.5 ms", "run.until=5 ms"};
    ASSERT_EQ(run(Words{"run", "baseline", "--detail", "rigid", "-q", "-o", "short.h5"} + set_all(settings)).status, 0);
    tasks::Scene scene = tasks::read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/baseline.toml");
    tasks::apply_detail(scene, "rigid");
    tasks::set_values(scene, settings);
    const double stated = tasks::record_bytes(scene, model::make_chain(scene.parameters));
    EXPECT_LT(static_cast<double>(std::filesystem::file_size(folder_ / "short.h5")), stated + 0.4e6);
    EXPECT_EQ(record("short.h5").rows(), 101u);
}

TEST_F(ProgramParts, ProgressIsReportedInPlainLinesWhereThereIsNoTerminal) {
    const tasks::Counters counters{};
    testing::internal::CaptureStderr();
    ProgressDisplay display(false, 20e-6, std::chrono::seconds(0));
    display.show({-20e-6, -20e-6, 0.0, 0.0, counters});
    display.show({-20e-6, -10e-6, 0.0, 1.0, counters});
    display.show({0.0, 0.0, 20e-6, 2.0, counters});
    display.show({0.0, 10e-6, 20e-6, 3.0, counters});
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "settling: 0 %, t = -20 us\n"
              "settling: 50 %, t = -10 us, 1e+05 s per simulated second (1e-05 x real time), 0:03 left\n"
              "running: 0 %, t = 0 s of 20 us\n"
              "running: 50 %, t = 10 us of 20 us, 1e+05 s per simulated second (1e-05 x real time), 0:01 left\n");
}

/// Every note that a record or a sweep can have.
TEST_F(ProgramParts, ListEveryNote) {
    const std::string notes = run({"list", "notes"}).out;
    for (const tasks::NoteKind& kind : tasks::note_kinds)
        EXPECT_THAT(notes, testing::ContainsRegex(fmt::format("\n{} +[a-z]", kind.name))) << kind.meaning;
}

}  // namespace
}  // namespace cvtflow::tools
