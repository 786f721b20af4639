#include "engine/record/run/run_file.hpp"

#include <gmock/gmock.h>
#include <hdf5.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

#include "engine/record/run/run_reader.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

namespace fs = std::filesystem;
using RunFileTest = RecordTest;

TEST_F(RunFileTest, TakesItsFinalNameOnlyWhenClosed) {
    RunFile file(path("out.h5"), example_contents());
    append_example(file, 0);
    file.flush();
    EXPECT_FALSE(fs::exists(path("out.h5")));
    EXPECT_TRUE(fs::exists(path("out.h5.part")));
    file.close();
    EXPECT_TRUE(fs::exists(path("out.h5")));
    EXPECT_FALSE(fs::exists(path("out.h5.part")));
    EXPECT_EQ(RunReader(path("out.h5")).status(), "finished");
}

TEST_F(RunFileTest, KeepsTheFormerFileUntilTheNewOneIsComplete) {
    {
        RunFile first(path("out.h5"), example_contents());
        append_example(first, 7);
        first.close();
    }
    RunFile second({path("out.h5"), {.force = true}}, example_contents());
    second.flush();
    EXPECT_EQ(RunReader(path("out.h5")).rows(), 1U);
    second.close();
    EXPECT_EQ(RunReader(path("out.h5")).rows(), 0U);
}

TEST_F(RunFileTest, GivesBackEveryRowAcrossManyChunksAndFlushes) {
    constexpr int rows = 1000;
    RunFile file(path("out.h5"), example_contents(), {.channel_rows = 64});
    for (int i = 0; i < rows; ++i) {
        append_example(file, i);
        if (i % 97 == 0) {
            file.flush();
        }
    }
    file.close();
    const RunReader reader(path("out.h5"));
    ASSERT_EQ(reader.rows(), static_cast<std::size_t>(rows));
    const auto times = reader.times();
    const auto ratio = reader.channel("ratio");
    const auto links = reader.channel("links/tension");
    for (int i = 0; i < rows; ++i) {
        const auto row = static_cast<std::size_t>(i);
        ASSERT_EQ(times[row], i / 1000.0);
        ASSERT_EQ(ratio[row], -i);
        ASSERT_EQ(links[3 * row + 2], 10.0 * i + 2);
    }
    EXPECT_EQ(reader.last("links/tension"), (std::vector<double>{9990, 9991, 9992}));
}

TEST_F(RunFileTest, SaysInterruptedAndKeepsThePartIfItIsNotClosed) {
    {
        RunFile file(path("out.h5"), example_contents());
        append_example(file, 3);
    }
    EXPECT_FALSE(fs::exists(path("out.h5")));
    const RunReader reader(path("out.h5.part"));
    EXPECT_EQ(reader.status(), "interrupted");
    EXPECT_EQ(reader.channel("strand_tension"), std::vector<double>{3.0});
}

TEST_F(RunFileTest, SaysWhatEndedTheRun) {
    {
        RunFile file(path("out.h5"), example_contents());
        file.set_status("fault: pin 12 left the sheave at t = 0.1 s");
    }
    EXPECT_EQ(RunReader(path("out.h5.part")).status(), "fault: pin 12 left the sheave at t = 0.1 s");
}

TEST_F(RunFileTest, FlushesByItselfAfterTheGivenTime) {
    RunFile file(path("out.h5"), example_contents(), {.flush_seconds = 0.02});
    append_example(file, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    append_example(file, 1);
    EXPECT_EQ(file.saved_rows(), 1U);
    EXPECT_EQ(RunReader(file.part_path()).status(), "running");
    EXPECT_EQ(RunReader(file.part_path()).rows(), 1U);
}

TEST_F(RunFileTest, AllocatesNothingBetweenChunks) {
    if (test::allocation_count() < 0) {
        GTEST_SKIP() << "malloc cannot be counted here";
    }
    RunFile file(path("out.h5"), example_contents(), {.flush_seconds = 1e9, .channel_rows = 512});
    const long before = test::allocation_count();
    for (int i = 0; i < 512; ++i) {
        append_example(file, i);
    }
    for (int i = 0; i < 64; ++i) {
        append_example_state(file, i);
        file.append_row("transitions", std::array{0.1 * i, 1.0 * i});
    }
    EXPECT_EQ(test::allocation_count(), before);
    append_example(file, 512);  // the chunk is complete, so HDF5 is called: the counter does count
    EXPECT_GT(test::allocation_count(), before);
}

TEST_F(RunFileTest, ReplacesAttributesLate) {
    RunFile file(path("out.h5"), example_contents());
    file.set_attribute({"pins", std::int64_t{42}});
    file.set_attribute({"note", std::string(100000, 'x')});
    file.close();
    const RunReader reader(path("out.h5"));
    EXPECT_EQ(reader.attribute("pins"), (Attribute{"pins", std::int64_t{42}}));
    EXPECT_EQ(reader.attribute("note"), (Attribute{"note", std::string(100000, 'x')}));
    EXPECT_EQ(reader.attribute("scene"), (Attribute{"scene", std::string("baseline")}));
}

TEST_F(RunFileTest, SaysWhyAFileCannotBeCreated) {
    const auto create = [](const std::string& name, RunFileOptions options = {}) {
        return error_of([&] { RunFile(name, example_contents(), options); });
    };
    fs::create_directory(path("folder"));
    EXPECT_EQ(create(path("missing/out.h5")),
              path("missing/out.h5") + ": cannot create: the folder '" + path("missing") + "' does not exist");
    EXPECT_EQ(create(path("folder")), path("folder") + ": cannot create: a folder, not a file");
    EXPECT_EQ(create(""), "cannot create a temporary file");
    fs::create_directory(path("out.h5.part"));
    EXPECT_EQ(create(path("out.h5")), path("out.h5.part") + ": cannot create: a folder, not a file");
    EXPECT_EQ(create("/proc/out.h5"), "/proc/out.h5.part: cannot create: No such file or directory");
    if (geteuid() != 0) {
        fs::permissions(path("folder"), fs::perms::owner_read | fs::perms::owner_exec);
        EXPECT_EQ(create(path("folder/out.h5")), path("folder/out.h5.part") + ": cannot create: Permission denied");
        fs::permissions(path("folder"), fs::perms::owner_all);
    }
}

TEST_F(RunFileTest, ReplacesNothingUnlessPermitted) {
    const auto create = [](const std::string& name) { return error_of([&] { RunFile(name, example_contents()); }); };
    {
        RunFile killed(path("a.h5"), example_contents());
        append_example(killed, 0);
    }
    EXPECT_EQ(create(path("a.h5")),
              path("a.h5.part") + ": already exists: rows of a run that was killed (cvtflow info shows them); --force replaces it");
    EXPECT_EQ(RunReader(path("a.h5.part")).rows(), 1U);
    {
        RunFile finished(path("b.h5"), example_contents());
        finished.close();
    }
    EXPECT_EQ(create(path("b.h5")), path("b.h5") + ": already exists and is not a file that may be replaced; --force replaces it");
}

TEST_F(RunFileTest, RefusesAFileThatAnotherRunIsWriting) {
    RunFile first(path("out.h5"), example_contents());
    append_example(first, 0);
    EXPECT_EQ(error_of([&] { RunFile(path("out.h5"), example_contents()); }),
              path("out.h5.part") + ": cannot create: another run is writing it");
    first.close();
    EXPECT_EQ(RunReader(path("out.h5")).rows(), 1U);
}

TEST_F(RunFileTest, RefusesContentsThatContradictAndLeavesNoFile) {
    const auto create = [this](const RunContents& contents) { return error_of([&] { RunFile(path("out.h5"), contents); }); };
    const std::string part = path("out.h5.part") + ": ";
    EXPECT_EQ(create({.channels = {{"a", "N", ""}, {"a", "N", ""}}}), part + "the channel 'a' is declared twice");
    EXPECT_EQ(create({.channels = {{"time", "s", ""}}}), part + "the name 'time' is reserved (channel)");
    EXPECT_EQ(create({.channels = {{"", "s", ""}}}), part + "'' cannot be the name of a channel");
    EXPECT_EQ(create({.channels = {{"a", "N", "", 0}}}), part + "the channel 'a' has width 0");
    EXPECT_EQ(create({.tables = {{"events", "", {}}}}), part + "the table 'events' has no columns");
    EXPECT_EQ(create({.attributes = {{"status", 1.0}}}), part + "the name 'status' is reserved (attribute)");
    EXPECT_THAT(create({.channels = {{"a", "N", ""}, {"a/b", "N", ""}}}),
                testing::StartsWith(part + "cannot create dataset '/channels/a/b': "));
    EXPECT_FALSE(fs::exists(path("out.h5.part")));
}

TEST_F(RunFileTest, RefusesRowsOfTheWrongShape) {
    RunFile file(path("out.h5"), example_contents());
    const std::string part = path("out.h5.part") + ": cannot write: ";
    EXPECT_EQ(error_of([&] { file.append(0.0, std::array{1.0}); }), part + "1 values of channels, not 5");
    EXPECT_EQ(error_of([&] { file.append_state(0.0, std::array{1.0}, {}); }), part + "1 values of a state, not 4");
    EXPECT_EQ(error_of([&] { file.append_row("transitions", std::array{1.0}); }), part + "1 values of a table's row, not 2");
    EXPECT_EQ(error_of([&] { file.append_row("events", std::array{1.0}); }), part + "no table 'events'");
    EXPECT_EQ(error_of([&] { file.append_row("transitions", std::array{1.0, 1.5}); }), part + "1.5 in the integer column 'pin'");
    file.close();
    EXPECT_EQ(error_of([&] { append_example(file, 0); }), path("out.h5") + ": cannot write: closed");
    EXPECT_EQ(RunReader(path("out.h5")).rows(), 0U);
}

TEST_F(RunFileTest, PrintsNothingAndLeavesTheHostsErrorPrinterInPlace) {
    H5E_auto2_t before = nullptr;
    H5E_auto2_t after = nullptr;
    void* client = nullptr;
    H5Eget_auto2(H5E_DEFAULT, &before, &client);
    testing::internal::CaptureStderr();
    EXPECT_NE(error_of([&] { RunFile(path("out.h5"), {.channels = {{"a", "N", ""}, {"a/b", "N", ""}}}); }), "no error");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    H5Eget_auto2(H5E_DEFAULT, &after, &client);
    EXPECT_EQ(before, after);
}

}  // namespace
}  // namespace cvtflow::engine
