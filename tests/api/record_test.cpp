/// Records and tables read by a host, sweeps run by it.

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>

#include "host_fixture.hpp"

namespace cvtflow::host {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class HostRecords : public testing::Test {
protected:
    HostRecords() : folder_(fs::temp_directory_path() / ("cvtflow_records_" + std::to_string(getpid()))) {
        fs::create_directories(folder_);
        std::ofstream(folder_ / "loads.toml") << "[sweep]\nscene = \"" CVTFLOW_SOURCE_DIR
                                                 "/scenes/tiny.toml\"\n[set]\nrun.until = \"0.05 ms\"\n"
                                              << "[[axes]]\nkey = \"load.torque\"\nvalues = [6, 12]\n"
                                              << "[outputs]\nscalars = [\"slip mean\"]\nrecords = true\n";
    }
    ~HostRecords() override { fs::remove_all(folder_); }

    /// A sweep of two cases with their records.
    fs::path swept() const {
        Sweep sweep = Sweep::read((folder_ / "loads.toml").string());
        EXPECT_EQ(sweep.cases(), 2);
        EXPECT_TRUE(sweep.run((folder_ / "out").string(), 1));
        return folder_ / "out";
    }

    fs::path folder_;
};

TEST_F(HostRecords, AreReadByRows) {
    const Record record((swept() / "records/case-000000.h5").string());
    EXPECT_EQ(record.status(), "finished");
    EXPECT_EQ(record.rows(), 6u);
    EXPECT_EQ(record.read("links/tension").size(), 6u * 24u);
    const std::vector<double> all = record.read("ratio");
    EXPECT_THAT(record.read("ratio", 2, 2), ElementsAre(all[2], all[3]));
    EXPECT_EQ(code_of([&] { static_cast<void>(record.read("ratio", 5, 2)); }), ErrorCode::argument);
    EXPECT_EQ(code_of([&] { static_cast<void>(record.read("rato")); }), ErrorCode::record);
    EXPECT_EQ(code_of([] { const Record none("/nowhere.h5"); }), ErrorCode::record);
}

TEST_F(HostRecords, ARecordingHoldsChannelsStatesAndTransitions) {
    const std::string file = (folder_ / "recorded.h5").string();
    Simulation simulation(tiny());
    Recording recording(simulation, file);
    EXPECT_EQ(code_of([&] { const Recording second(simulation, (folder_ / "second.h5").string()); }), ErrorCode::state);
    simulation.advance_to(0.0);  // settling is not recorded
    simulation.advance_to(2.3e-5);
    simulation.advance_to(5e-5);
    recording.finish();
    EXPECT_EQ(code_of([&] { recording.finish(); }), ErrorCode::state);
    const Record record(file);
    EXPECT_EQ(record.status(), "finished");
    EXPECT_EQ(record.rows(), 6u);
    EXPECT_EQ(record.read("ratio").back(), simulation.channel("ratio")[0]);
    EXPECT_EQ(record.transitions().size(), static_cast<std::size_t>(simulation.counters().transitions));
    ASSERT_EQ(record.state_times().size(), 1u);
    EXPECT_EQ(record.state(0).size(), simulation.size());
    EXPECT_EQ(record.phases(0).size(), 4u * 24u);
    EXPECT_EQ(code_of([&] { static_cast<void>(record.state(1)); }), ErrorCode::argument);
}

TEST_F(HostRecords, ARecordingWithoutAnEndLeavesItsRows) {
    const std::string file = (folder_ / "left.h5").string();
    {
        Simulation simulation(tiny());
        const Recording recording(simulation, file);
        simulation.advance_to(1e-5);
    }
    EXPECT_FALSE(fs::exists(file));
    EXPECT_EQ(Record(file + ".part").rows(), 2u);
    Simulation again(tiny());
    EXPECT_EQ(code_of([&] { const Recording other(again, file); }), ErrorCode::record) << "rows of a killed run";
    EXPECT_EQ(Record(file + ".part").rows(), 2u);
    Recording(again, file, true).finish();
    EXPECT_EQ(code_of([&] { const Recording other(again, file); }), ErrorCode::record) << "a record of the same scene";
}

TEST(HostScenes, ListTheirKeysAndReadQuantities) {
    const std::vector<KeyInfo> keys = scene_keys();
    const Scene scene = Scene::parse("");
    for (const KeyInfo& key : keys) EXPECT_EQ(scene.value(key.name), key.name == "scene.name" ? "\"scene\"" : key.usual) << key.name;
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
    Sweep sweep = Sweep::read((folder_ / "loads.toml").string());
    sweep.cancel();
    EXPECT_FALSE(sweep.run((folder_ / "out").string(), 1));
    long done = 0;
    EXPECT_TRUE(sweep.run((folder_ / "out").string(), 1, [&](const SweepProgress& now) { done = now.before + now.done; }));
    EXPECT_EQ(done, 2);
    EXPECT_EQ(code_of([&] { sweep.run((folder_ / "out").string(), -1); }), ErrorCode::argument);
    EXPECT_EQ(code_of([&] { static_cast<void>(Sweep::read("/nowhere.toml")); }), ErrorCode::scene);
}

}  // namespace
}  // namespace cvtflow::host
