#include "engine/record/run/state_file.hpp"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <bit>
#include <csignal>
#include <fstream>
#include <limits>
#include <thread>

#include "engine/record/run/run_file.hpp"
#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

namespace fs = std::filesystem;
using StateFileTest = RecordTest;

SavedState example(std::size_t size = 100) {
    SavedState saved{{"1.0.0", "rk4", 7, std::string(3000, 'x'), 1e-7, 0.5, {1.0, 2.0}}, 0.25, {}, {0, 1, 255}};
    for (std::size_t i = 0; i < size; ++i) saved.state.push_back(1.0 / (1.0 + static_cast<double>(i)));
    return saved;
}

std::string reading(const std::string& name) {
    return error_of([&] { (void)read_state(name); });
}

TEST_F(StateFileTest, GivesBackWhatWasWritten) {
    for (const SavedState& saved : {example(), SavedState{}, example(200'000)}) {
        write_state(path("s"), saved);
        EXPECT_EQ(read_state(path("s")), saved);
        EXPECT_FALSE(fs::exists(path("s.part")));
    }
}

TEST_F(StateFileTest, KeepsEveryBit) {
    SavedState saved;
    saved.state = {std::bit_cast<double>(0x7ff8000000000123ULL), -0.0, std::numeric_limits<double>::denorm_min()};
    write_state(path("s"), saved);
    const SavedState back = read_state(path("s"));
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_EQ(std::bit_cast<std::uint64_t>(back.state[k]), std::bit_cast<std::uint64_t>(saved.state[k]));
}

TEST_F(StateFileTest, LeavesTheFormerFileIfTheDiskIsFull) {
    write_state(path("s"), example());
    const int child = start_child([this] {
        std::signal(SIGXFSZ, SIG_IGN);
        const rlimit limit{100'000, RLIM_INFINITY};
        setrlimit(RLIMIT_FSIZE, &limit);
        const std::string message = error_of([this] { write_state(path("s"), example(200'000)); });
        std::ofstream(path("message")) << message;
    });
    EXPECT_EQ(wait_for(child), 0);
    EXPECT_EQ(read_text_file(path("message")), path("s") + ": cannot write: File too large");
    EXPECT_EQ(read_state(path("s")), example());
    EXPECT_FALSE(fs::exists(path("s.part")));
}

TEST_F(StateFileTest, ReportsWhyAFileCannotBeRead) {
    EXPECT_EQ(reading(path("absent")), path("absent") + ": No such file or directory");
    EXPECT_EQ(reading(fs::path(path("absent")).parent_path().string()),
              fs::path(path("absent")).parent_path().string() + ": a folder, not a file");
    std::ofstream(path("text")) << "no state at all, but longer than one's head\n";
    EXPECT_EQ(reading(path("text")), path("text") + ": not a state");
    write_state(path("s"), example());
    const std::string good = read_text_file(path("s"));
    for (const std::size_t at : {std::size_t{20}, good.size() / 2, good.size() - 1}) {
        std::string bad = good;
        bad[at] = static_cast<char>(good[at] ^ 1);
        std::ofstream(path("s")) << bad;
        EXPECT_EQ(reading(path("s")), path("s") + ": a damaged state: its checksum differs") << at;
    }
    for (const std::size_t size : {std::size_t{10}, std::size_t{18}, good.size() / 2}) {
        std::ofstream(path("s")) << good.substr(0, size);
        EXPECT_THAT(reading(path("s")), testing::HasSubstr("state")) << size;
    }
    std::ofstream(path("s")) << "CVTFLOW7" << good;
    EXPECT_EQ(reading(path("s")), path("s") + ": a state of version 0.4: settle or run again");
}

/// h5py writes what version 0.4 wrote.
TEST_F(StateFileTest, TakesTheLastStateOfARecordAndRefusesAStateOfVersion04) {
    RunContents contents;
    contents.state_size = 2;
    contents.phase_count = 1;
    contents.attributes = {{"parameters", std::string("scene")}, {"step_taken", 1e-6}};
    {
        RunFile run(path("run.h5"), contents);
        const std::uint8_t phase = 1;
        for (const double time : {0.0, 0.5}) run.append_state(time, std::vector{time, 2.0}, {&phase, 1});
        run.close();
    }
    const SavedState last = read_state(path("run.h5"));
    EXPECT_EQ(last.time, 0.5);
    EXPECT_EQ(last.state, (std::vector{0.5, 2.0}));
    EXPECT_EQ(last.scene, "scene");
    EXPECT_EQ(last.step, 1e-6);
    {
        RunFile run(path("none.h5"), {});
        run.close();
    }
    EXPECT_EQ(reading(path("none.h5")), path("none.h5") + ": no states recorded");
    python(
        "import h5py, sys, numpy\nf = h5py.File(sys.argv[1], \"w\", libver=(\"v108\", \"v110\")); f.attrs[\"format\"] = "
        "numpy.bytes_(\"cvtflow state\")",
        path("old.h5"));
    EXPECT_THAT(reading(path("old.h5")), testing::HasSubstr("state of version 0.4: settle or run again"));
}

}  // namespace
}  // namespace cvtflow::engine
