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

TEST_F(HostRecords, TablesAreReadByColumns) {
    const Table table((swept() / "cases.h5").string());
    EXPECT_EQ(table.rows(), 2u);
    EXPECT_THAT(table.numbers("load_torque"), ElementsAre(6.0, 12.0));
    EXPECT_THAT(table.texts("status"), ElementsAre("ok", "ok"));
    EXPECT_EQ(code_of([&] { static_cast<void>(table.numbers("status")); }), ErrorCode::argument);
    EXPECT_THAT(error_of([&] { static_cast<void>(table.numbers("load_torqe")); }), HasSubstr("did you mean \"load_torque\""));
}

TEST_F(HostRecords, ASweepThatIsCancelledGoesOn) {
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
