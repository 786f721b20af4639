/// Records written and sweeps run by a host.

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class HostRecords : public testing::Test {
protected:
    HostRecords() : folder_(fs::temp_directory_path() / ("cvtflow_records_" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
        std::ofstream(folder_ / "loads.toml") << "[sweep]\nscene = \"" CVTFLOW_SOURCE_DIR
                                                 "/scenes/tiny.toml\"\n[set]\nrun.until = \"0.05 ms\"\n"
                                              << "[[axes]]\nkey = \"load.torque\"\nvalues = [6, 12]\n"
                                              << "[outputs]\nscalars = [\"slip mean\"]\n";
    }
    ~HostRecords() override { fs::remove_all(folder_); }

    [[nodiscard]] std::string file(const char* name) const { return (folder_ / name).string(); }

    fs::path folder_;
};

/// What is in it: tests of the Python package.
TEST_F(HostRecords, ARecordingIsOneAtATimeAndEndsOnce) {
    Simulation simulation(tiny());
    Recording recording(simulation, file("recorded.h5"));
    EXPECT_EQ(code_of([&] { const Recording second(simulation, file("second.h5")); }), ErrorCode::state);
    simulation.advance_to(0.0);
    simulation.advance_to(5e-5);
    EXPECT_FALSE(fs::exists(file("recorded.h5")));
    Recording moved = std::move(recording);
    moved.finish();
    EXPECT_GT(fs::file_size(file("recorded.h5")), 1000u);
    EXPECT_EQ(code_of([&] { moved.finish(); }), ErrorCode::state);
    EXPECT_EQ(code_of([&] { const Recording other(simulation, file("none/there.h5")); }), ErrorCode::record);
    const Recording second(simulation, file("second.h5"));
}

TEST_F(HostRecords, ARecordingWithoutAnEndLeavesItsRows) {
    const std::string left = file("left.h5");
    {
        Simulation simulation(tiny());
        const Recording recording(simulation, left);
        simulation.advance_to(1e-5);
    }
    EXPECT_FALSE(fs::exists(left));
    const auto size = fs::file_size(left + ".part");
    Simulation again(tiny());
    EXPECT_EQ(code_of([&] { const Recording other(again, left); }), ErrorCode::record) << "rows of a killed run";
    EXPECT_EQ(fs::file_size(left + ".part"), size);
    Recording(again, left, true).finish();
    EXPECT_EQ(code_of([&] { const Recording other(again, left); }), ErrorCode::record) << "a record of the same scene";
}

TEST(HostScenes, KnowTheirKeysAndReadQuantities) {
    EXPECT_THAT(describe("keys"), HasSubstr("\"name\":\"load.torque\""));
    EXPECT_THAT(describe("scenes"), HasSubstr("\"name\":\"baseline\""));
    EXPECT_THAT(error_of([] { static_cast<void>(describe("kees")); }), HasSubstr("did you mean \"keys\"?"));
    EXPECT_EQ(quantity("0.1 ms", "s"), 1e-4);
    EXPECT_EQ(quantity("1 %", "1"), 0.01);
    EXPECT_THAT(error_of([] { static_cast<void>(quantity("1 mm", "s")); }), HasSubstr("\"1 mm\" is a length, expected a time (s)"));
    EXPECT_THAT(error_of([] { static_cast<void>(quantity("1", "s")); }), HasSubstr("has no unit, expected a time"));
}

TEST(HostScenes, NameTheSettingThatIsWrong) {
    const auto with = [](const std::string& setting) { return error_of([&] { static_cast<void>(tiny({setting})); }); };
    EXPECT_THAT(with("load.torqe=8"), testing::StartsWith("load.torqe=8: load.torqe: unknown key"));
    std::string table = "load.torque=[[0, 1]";
    for (int point = 0; point < 1000; ++point) table += ", [0, 1]";
    EXPECT_THAT(with(table + "]"), testing::Not(HasSubstr("[0, 1], [0, 1], [0, 1], [0, 1], [0, 1], [0, 1], [0, 1], [0, 1]")));
}

TEST_F(HostRecords, ASweepThatIsCancelledContinues) {
    Sweep sweep = Sweep::read(file("loads.toml"));
    EXPECT_EQ(sweep.cases(), 2);
    sweep.cancel();
    EXPECT_FALSE(sweep.run(file("out"), 1));
    long done = 0;
    EXPECT_TRUE(sweep.run(file("out"), 1, [&](const SweepProgress& now) { done = now.before + now.done; }));
    EXPECT_EQ(done, 2);
    EXPECT_EQ(code_of([&] { sweep.run(file("out"), -1); }), ErrorCode::argument);
    EXPECT_EQ(code_of([&] { static_cast<void>(Sweep::read("/nowhere.toml")); }), ErrorCode::scene);
}

}  // namespace
}  // namespace cvtflow::host
