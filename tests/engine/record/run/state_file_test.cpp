#include "engine/record/run/state_file.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <bit>
#include <csignal>
#include <fstream>
#include <limits>
#include <thread>

#include "engine/record/hdf5/file_seal.hpp"
#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

namespace fs = std::filesystem;
using StateFileTest = RecordTest;

SavedState example(std::size_t size = 100) {
    SavedState saved{
        0.25, {}, {0, 1, 255}, "cbf29ce484222325", {{"scene", std::string("baseline")}, {"step", 1e-7}, {"steps", std::int64_t{1} << 40U}}};
    for (std::size_t i = 0; i < size; ++i) {
        saved.state.push_back(1.0 / (1.0 + static_cast<double>(i)));
    }
    return saved;
}

std::string reading(const std::string& name) {
    return error_of([&] { (void)read_state(name); });
}

/// States are usual, empty, large, with further numbers by name, and with texts that are longer than an object header.
TEST_F(StateFileTest, GivesBackWhatWasWritten) {
    SavedState more = example(), texts = example();
    more.more = {{"a", {1.0, -0.0}}, {"b", {}}};
    texts.attributes = {{"empty", std::string()}, {"scene", std::string(300'000, 'x')}};
    for (const SavedState& saved : {example(), SavedState{}, example(200'000), more, texts}) {
        write_state(path("s.h5"), saved);
        EXPECT_EQ(read_state(path("s.h5")), saved);
        EXPECT_FALSE(fs::exists(path("s.h5.part")));
    }
}

TEST_F(StateFileTest, KeepsEveryBit) {
    const double odd_nan = std::bit_cast<double>(0x7ff8000000000123ULL);
    write_state(path("s.h5"), {.time = -0.0, .state = {odd_nan, -0.0, std::numeric_limits<double>::denorm_min()}});
    const SavedState back = read_state(path("s.h5"));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back.state[0]), 0x7ff8000000000123ULL);
    EXPECT_TRUE(std::signbit(back.state[1]) && std::signbit(back.time));
    EXPECT_EQ(back.state[2], std::numeric_limits<double>::denorm_min());
}

TEST_F(StateFileTest, MayBeWrittenByManyThreadsAtOnce) {
    std::vector<std::jthread> writers;
    for (int writer = 0; writer < 4; ++writer) {
        writers.emplace_back([&, writer] {
            for (int i = 0; i < 50; ++i)
                write_state(path("s" + std::to_string(writer) + ".h5"), example(static_cast<std::size_t>(100 + writer)));
        });
    }
    writers.clear();
    for (int writer = 0; writer < 4; ++writer)
        EXPECT_EQ(read_state(path("s" + std::to_string(writer) + ".h5")), example(static_cast<std::size_t>(100 + writer)));
}

TEST_F(StateFileTest, LeavesTheFormerFileIfTheDiskIsFull) {
    write_state(path("s.h5"), example());
    const int child = start_child([this] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{100'000, RLIM_INFINITY};
        setrlimit(RLIMIT_FSIZE, &limit);
        const std::string message = error_of([this] { write_state(path("s.h5"), example(200'000)); });
        std::ofstream(path("message")) << message;
    });
    EXPECT_EQ(wait_for(child), 0);
    EXPECT_EQ(read_text_file(path("message")), path("s.h5") + ": cannot write: File too large");
    EXPECT_EQ(read_state(path("s.h5")), example());
    EXPECT_FALSE(fs::exists(path("s.h5.part")));
}

TEST_F(StateFileTest, ReportsWhyAFileCannotBeWritten) {
    EXPECT_EQ(error_of([&] { write_state(path("absent/s.h5"), {}); }),
              path("absent/s.h5") + ": cannot create: the folder '" + path("absent") + "' does not exist");
    EXPECT_EQ(error_of([&] {
                  write_state(path("s.h5"), {.attributes = {{"time", 1.0}}});
              }),
              path("s.h5") + ": the name 'time' is reserved (attribute)");
}

TEST_F(StateFileTest, ReportsWhyAFileCannotBeRead) {
    EXPECT_EQ(reading(path("absent.h5")), path("absent.h5") + ": No such file or directory");
    {
        RunFile run(path("run.h5"), {});
        run.close();
    }
    EXPECT_EQ(reading(path("run.h5")), path("run.h5") + ": an HDF5 file, but not a state file (it is a record of a run)");
    write_state(path("s.h5"), example());
    const auto size = fs::file_size(path("s.h5")) - seal_size;
    fs::resize_file(path("s.h5"), size - 100);
    EXPECT_EQ(reading(path("s.h5")),
              path("s.h5") + ": truncated HDF5 file: " + std::to_string(size - 100) + " bytes of " + std::to_string(size));
}

TEST_F(StateFileTest, NoticesAStateThatChangedOnDisk) {
    write_state(path("s.h5"), example());
    const std::string good = read_text_file(path("s.h5"));
    python("import h5py, sys\nf = h5py.File(sys.argv[1], \"r+\"); f[\"y\"][7] += 1e-15",
           path("s.h5"));  // which cuts the file where HDF5's part of it ends
    EXPECT_EQ(reading(path("s.h5")), path("s.h5") + ": damaged HDF5 file (no seal: changed after it was finished, or truncated)");
    std::string bad = good;
    bad[good.size() / 2] = static_cast<char>(good[good.size() / 2] ^ 1);
    std::ofstream(path("s.h5")) << bad;
    EXPECT_EQ(reading(path("s.h5")), path("s.h5") + ": damaged HDF5 file (changed after it was finished: its checksum differs)");
}

TEST_F(StateFileTest, H5pyReadsTheFileNaturally) {
    write_state(path("s.h5"), example());
    const std::string program =
        "import h5py, sys\n"
        "f = h5py.File(sys.argv[1], \"r\")\n"
        "print(f.attrs[\"fingerprint\"], f.attrs[\"time\"], f[\"y\"][1], f[\"phases\"][:])";
    EXPECT_EQ(python(program, path("s.h5")), "b'cbf29ce484222325' 0.25 0.5 [  0   1 255]\n");
}

}  // namespace
}  // namespace cvtflow::engine
