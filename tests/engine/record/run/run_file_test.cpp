#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "engine/record/run/run_file.hpp"
#include "engine/record/run/run_reader.hpp"
#include "engine/record/run/schema.hpp"
#include "tests/engine/allocation_fixture.hpp"
#include "tests/engine/record/record_fixture.hpp"
#include "tests/sample_fixture.hpp"

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
    RunFile second({path("out.h5"), any_file()}, example_contents());
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

/// Which h5py verifies, as every program does that uses HDF5. A chunk that is still growing has none.
TEST_F(RunFileTest, HasAChecksumInEachFullChunkAndInTheLastOnceItIsFinished) {
    const std::string masks =
        "import h5py, sys\n"
        "f = h5py.File(sys.argv[1], \"r\", swmr=True, locking=False); d = f[\"channels/links/tension\"].id\n"
        "print([d.get_chunk_info(k).filter_mask for k in range(d.get_num_chunks())], f[\"channels/ratio\"][-1])";
    RunFile file(path("out.h5"), example_contents(), {.channel_rows = 16});
    for (int i = 0; i < 20; ++i) append_example(file, i);
    file.flush();
    EXPECT_EQ(python(masks, path("out.h5.part")), "[0, 1] -19.0\n");
    for (int i = 20; i < 40; ++i) append_example(file, i);
    file.close();
    EXPECT_EQ(python(masks, path("out.h5")), "[0, 0, 0] -39.0\n");
    const std::string flipped =
        "import h5py, sys\n"
        "f = h5py.File(sys.argv[1], \"r\"); at = f[\"channels/ratio\"].id.get_chunk_info(2).byte_offset; f.close()\n"
        "b = bytearray(open(sys.argv[1], \"rb\").read()); b[at + 9] ^= 4; open(sys.argv[1], \"wb\").write(b)\n"
        "d = h5py.File(sys.argv[1], \"r\")[\"channels/ratio\"]; print(d[31])\n"
        "try: d[32]\n"
        "except OSError as error: print(\"checksum\" in str(error) or \"filter\" in str(error))";
    EXPECT_EQ(python(flipped, path("out.h5")), "-31.0\nTrue\n");
}

TEST_F(RunFileTest, ReportsInterruptedOrWhatEndedTheRunAndKeepsThePartIfItIsNotClosed) {
    {
        RunFile file(path("out.h5"), example_contents());
        append_example(file, 3);
        RunFile ended(path("ended.h5"), example_contents());
        ended.set_status("fault: pin 12 left the sheave at t = 0.1 s");
    }
    EXPECT_EQ(RunReader(path("ended.h5.part")).status(), "fault: pin 12 left the sheave at t = 0.1 s");
    EXPECT_FALSE(fs::exists(path("out.h5")));
    const RunReader reader(path("out.h5.part"));
    EXPECT_EQ(reader.status(), "interrupted");
    EXPECT_EQ(reader.channel("strand_tension"), std::vector<double>{3.0});
}

TEST_F(RunFileTest, FlushesByItselfAfterTheGivenTime) {
    RunFile now(path("now.h5"), example_contents(), {.flush_seconds = 0.0}),
        never(path("never.h5"), example_contents(), {.flush_seconds = 1e9});
    for (const int row : {0, 1}) append_example(now, row), append_example(never, row);
    EXPECT_EQ(RunReader(path("now.h5.part")).status(), "running");
    EXPECT_EQ(RunReader(path("now.h5.part")).rows(), 1U);
    EXPECT_EQ(RunReader(path("never.h5.part")).rows(), 0U);
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
    EXPECT_THAT(reader.attributes(), testing::Contains(Attribute{"pins", std::int64_t{42}}));
    EXPECT_THAT(reader.attributes(), testing::Contains(Attribute{"note", std::string(100000, 'x')}));
    EXPECT_THAT(reader.attributes(), testing::Contains(Attribute{"scene", std::string("baseline")}));
}

TEST_F(RunFileTest, ReportsWhyAFileCannotBeCreated) {
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
    const std::string long_name = path(std::string(252, 'x'));  // 255 bytes at most, .part included
    EXPECT_EQ(create(long_name), long_name + ".part: cannot create: File name too long");
    if (geteuid() != 0) {
        fs::permissions(path("folder"), fs::perms::owner_read | fs::perms::owner_exec);
        EXPECT_EQ(create(path("folder/out.h5")), path("folder/out.h5") + ": cannot create: Permission denied");
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
              path("a.h5.part") + ": already exists, left by a command that was killed (cvtflow info shows the rows of a run); --force replaces it");
    EXPECT_EQ(RunReader(path("a.h5.part")).rows(), 1U);
    {
        RunFile finished(path("b.h5"), example_contents());
        finished.close();
    }
    EXPECT_EQ(create(path("b.h5")), path("b.h5") + ": already exists; --force replaces it");
}

TEST_F(RunFileTest, RefusesAFileThatAnotherRunIsWriting) {
    RunFile first(path("out.h5"), example_contents());
    append_example(first, 0);
    EXPECT_EQ(error_of([&] { RunFile(path("out.h5"), example_contents()); }),
              path("out.h5.part") + ": cannot create: process " + std::to_string(getpid()) + " is writing it");
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
    std::array few{1.0};
    EXPECT_EQ(error_of([&] { file.append(0.0, few); }), part + "1 values of channels, not 5");
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

using RunWriterTest = RecordTest;

/// Every row and state that the reader finds is the one that was appended. Returns rows.
std::size_t check_example(const std::string& path) {
    const RunReader reader(path);
    const auto times = reader.times();
    const auto tension = reader.channel("strand_tension");
    const auto links = reader.channel("links/tension");
    for (std::size_t i = 0; i < reader.rows(); ++i) {
        const double number = static_cast<double>(i);
        EXPECT_EQ(times[i], number / 1000.0);
        EXPECT_EQ(tension[i], number);
        EXPECT_EQ(links[3 * i + 1], 10.0 * number + 1);
    }
    if (const auto state_times = reader.state_times(); !state_times.empty()) {
        EXPECT_EQ(reader.state(state_times.size() - 1).state.front(), static_cast<double>(state_times.size() - 1) + 0.25);
    }
    return reader.rows();
}

/// A child appends and flushes as fast as it can, telling in `flushed` (a pipe) how many rows it has brought to safety.
void write_without_end(const std::string& path, int pipe_end) {
    RunFile file({path, any_file()}, example_contents(), {.flush_seconds = 1e9, .channel_rows = 16});
    for (int i = 0;; ++i) {
        append_example(file, i);
        append_example_state(file, i);
        file.append_row("transitions", std::array{0.1 * i, 1.0 * i});
        if (i % 40 == 39) {
            file.flush();
            const int rows = i + 1;
            (void)!write(pipe_end, &rows, sizeof rows);
        }
    }
}

TEST_F(RunWriterTest, AFileOfARunKilledAtAnyInstantIsReadable) {
    for (int trial = 0; trial < cvtflow::test::depth(5, 25); ++trial) {
        int ends[2] = {};
        ASSERT_EQ(pipe(ends), 0);
        const int child = start_child([&] { write_without_end(path("out.h5"), ends[1]); });
        ::close(ends[1]);
        int promised = 0;
        ASSERT_EQ(read(ends[0], &promised, sizeof promised), static_cast<ssize_t>(sizeof promised));
        std::this_thread::sleep_for(std::chrono::microseconds(1733 * trial));
        kill(child, SIGKILL);
        wait_for(child);
        for (int next = 0; read(ends[0], &next, sizeof next) > 0;) {
            promised = next;
        }
        ::close(ends[0]);
        EXPECT_GE(check_example(path("out.h5.part")), static_cast<std::size_t>(promised)) << "trial " << trial;
    }
}

/// Space is allotted before it is written: a writer that is killed in between leaves less than the head of its file states.
TEST_F(RunWriterTest, ALiveFileWhoseLastSpaceWasNotWrittenIsReadable) {
    RunFile file(path("out.h5"), example_contents());
    append_example(file, 0);
    file.flush();
    std::filesystem::copy_file(path("out.h5.part"), path("short.h5"));
    std::filesystem::resize_file(path("short.h5"), std::filesystem::file_size(path("short.h5")) - 2048);
    EXPECT_EQ(check_example(path("short.h5")), 1U);
    file.close();
    std::filesystem::resize_file(path("out.h5"), std::filesystem::file_size(path("out.h5")) - 4096);
    EXPECT_THAT(error_of([&] { RunReader(path("out.h5")); }), testing::HasSubstr("truncated"));
}

TEST_F(RunWriterTest, ALiveFileCanBeReadWhileItIsWrittenAndDoesNotDisturbTheWriter) {
    RunFile file(path("out.h5"), example_contents());
    append_example(file, 0);
    file.flush();
    const RunReader early(path("out.h5.part"));
    append_example(file, 1);
    file.flush();
    EXPECT_EQ(early.rows(), 1U);
    const std::string program = "import h5py, sys\nf = h5py.File(sys.argv[1], \"r\", swmr=True); print(f[\"channels/ratio\"][:])";
    EXPECT_EQ(python(program, path("out.h5.part")), "[-0. -1.]\n");
    file.close();
    EXPECT_EQ(check_example(path("out.h5")), 2U);
}

/// Limits the size of files that this process may write, and takes the error instead of the signal.
void limit_file_size(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
}

/// Appends until an error comes, and writes its message to a file. Returns the number of rows taken.
int append_until_error(RunFile& file, int first, const std::string& message_path) {
    for (int i = first;; ++i) {
        if (const std::string message = error_of([&] { append_example(file, i); }); message != "no error") {
            limit_file_size(RLIM_INFINITY);
            std::ofstream(message_path) << message;
            return i;
        }
    }
}

/// Makes writing fail as a broken disk does, which no reservation can foresee. HDF5's descriptor is the one opened last.
void break_last_descriptor_of(const std::string& path) {
    int last = -1;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
        std::error_code gone;
        if (std::filesystem::read_symlink(entry.path(), gone) == path) {
            last = std::max(last, std::stoi(entry.path().filename().string()));
        }
    }
    if (last < 0 || dup2(open("/dev/null", O_RDONLY), last) < 0) {
        throw std::runtime_error("no descriptor to break");
    }
}

TEST_F(RunWriterTest, ReportsPathReasonAndWhatIsSavedIfTheDiskIsFullAndContinuesOnceThereIsRoom) {
    const int child = start_child([this] {
        {
            RunFile file(path("out.h5"), example_contents(), {.flush_seconds = 1e9, .channel_rows = 100});
            limit_file_size(400'000);
            append_until_error(file, 0, path("message"));
        }
        RunFile file(path("continued.h5"), example_contents(), {.flush_seconds = 1e9, .channel_rows = 100});
        limit_file_size(400'000);
        for (int i = append_until_error(file, 0, path("again")); i < 20'000; ++i) append_example(file, i);
        file.close();
    });
    EXPECT_EQ(wait_for(child), 0);
    EXPECT_EQ(check_example(path("continued.h5")), 20'000U) << "without loss once there is room again";
    const std::size_t rows = check_example(path("out.h5.part"));
    EXPECT_GT(rows, 1000U);
    // Room is made for 100 rows at a time; those that wait in memory are saved by the destructor, for which there is room again.
    EXPECT_EQ(read_text_file(path("message")), fmt::format("{}: cannot write: File too large; saved: {} rows up to t = {:.9g} s",
                                                           path("out.h5.part"), rows - 100, static_cast<double>(rows - 101) / 1000.0));
    EXPECT_EQ(RunReader(path("out.h5.part")).status(), "interrupted");
}

void record_on_a_breaking_disk(const std::string& path, const std::string& message_path) {
    RunFile file(path, example_contents(), {.flush_seconds = 1e9, .channel_rows = 100});
    for (int i = 0; i < 1000; ++i) {
        append_example(file, i);
    }
    file.flush();
    break_last_descriptor_of(path + ".part");
    const int failed = append_until_error(file, 1000, message_path);
    if (error_of([&] { append_example(file, failed); }) != read_text_file(message_path)) {
        throw std::runtime_error("the error is not repeated");
    }
}

TEST_F(RunWriterTest, SurvivesAnErrorInsideHdf5AndKeepsWhatWasSaved) {
    const int child = start_child([this] {
        (void)!std::freopen(path("stderr").c_str(), "w", stderr);
        record_on_a_breaking_disk(path("out.h5"), path("message"));
        std::exit(0);  // HDF5 closes files at exit, which must neither hang nor abort
    });
    EXPECT_EQ(wait_for(child), 0);
    EXPECT_EQ(read_text_file(path("message")),
              path("out.h5.part") + ": cannot write: Bad file descriptor; saved: 1000 rows up to t = 0.999 s");
    EXPECT_EQ(read_text_file(path("stderr")), "");
    EXPECT_EQ(check_example(path("out.h5.part")), 1000U);
}

TEST(Schema, MakesAttributesOfProvenance) {
    const Provenance here = current_provenance();
    const auto attributes = attributes_of(here);
    EXPECT_THAT(attributes, testing::Contains(Attribute{"commit", here.commit}));
    EXPECT_THAT(attributes, testing::Contains(Attribute{"cores", std::int64_t{here.cores}}));
    const auto is_version = [](const Attribute& each) { return each.name == "hdf5_version"; };
    const auto version = std::find_if(attributes.begin(), attributes.end(), is_version);
    ASSERT_NE(version, attributes.end());
    EXPECT_THAT(std::get<std::string>(version->value), testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
}

}  // namespace
}  // namespace cvtflow::engine
