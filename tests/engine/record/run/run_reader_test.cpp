#include "engine/record/run/run_reader.hpp"

#include <gmock/gmock.h>
#include <hdf5.h>

#include <array>
#include <fstream>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/run/state_file.hpp"
#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

namespace fs = std::filesystem;

class RunReaderTest : public RecordTest {
protected:
    /// A finished run of 10 rows, 5 states and 3 transitions.
    std::string example() const {
        RunFile file(path("out.h5"), example_contents());
        for (int i = 0; i < 10; ++i) {
            append_example(file, i);
        }
        for (int i = 0; i < 5; ++i) {
            append_example_state(file, i);
        }
        for (int i = 0; i < 3; ++i) {
            file.append_row("transitions", std::array{0.5 * i, 80.0 + i});
        }
        file.close();
        return path("out.h5");
    }
    static std::string opening(const std::string& name) {
        return error_of([&] { RunReader reader(name); });
    }
};

TEST_F(RunReaderTest, GivesChannelsTablesAttributesAndStatesAsTheyWereWritten) {
    const RunReader reader(example());
    EXPECT_EQ(reader.channels(), example_contents().channels);
    EXPECT_EQ(reader.rows(), 10U);
    EXPECT_EQ(reader.tables(), example_contents().tables);
    EXPECT_EQ(reader.table("transitions"), (std::vector<std::vector<double>>{{0.0, 80.0}, {0.5, 81.0}, {1.0, 82.0}}));
    EXPECT_THAT(reader.attributes(), testing::UnorderedElementsAreArray(example_contents().attributes));
    EXPECT_EQ(attribute_value<std::string>(reader.attributes(), "absent"), nullptr);
    EXPECT_EQ(reader.state_times().size(), 5U);
    EXPECT_EQ(reader.state(4), (RecordedState{0.4, {4.25, 4.5, 4.75, 5.0}, {4, 1}}));
    EXPECT_EQ(reader.state(2).time, 0.2);
    EXPECT_EQ(reader.state(0).phases, (std::vector<std::uint8_t>{0, 1}));
    EXPECT_EQ(error_of([&] { (void)reader.channel("torque"); }), path("out.h5") + ": no channel 'torque'");
    EXPECT_EQ(error_of([&] { (void)reader.last("torque"); }), path("out.h5") + ": no channel 'torque'");
    EXPECT_EQ(error_of([&] { (void)reader.table("events"); }), path("out.h5") + ": no table 'events'");
}

TEST_F(RunReaderTest, ReadsARunWithoutAnything) {
    {
        RunFile file(path("empty.h5"), {});
        file.close();
    }
    const RunReader reader(path("empty.h5"));
    EXPECT_TRUE(reader.channels().empty());
    EXPECT_TRUE(reader.tables().empty());
    EXPECT_TRUE(reader.times().empty());
    EXPECT_TRUE(reader.state_times().empty());
    EXPECT_EQ(error_of([&] { (void)reader.state(0); }), path("empty.h5") + ": no states recorded");
}

TEST_F(RunReaderTest, ReportsWhyAFileCannotBeOpened) {
    EXPECT_EQ(opening(path("absent.h5")), path("absent.h5") + ": No such file or directory");
    EXPECT_EQ(opening(path("")), path("") + ": a folder, not a file");
    std::ofstream(path("text.h5")) << "time, tension\n";
    EXPECT_EQ(opening(path("text.h5")), path("text.h5") + ": not an HDF5 file");
    std::ofstream(path("nothing.h5")).flush();
    EXPECT_EQ(opening(path("nothing.h5")), path("nothing.h5") + ": not an HDF5 file");
}

TEST_F(RunReaderTest, ReportsTheSizeOfATruncatedFile) {
    const std::string name = example();
    const auto size = fs::file_size(name) - seal_size;
    fs::resize_file(name, size / 2);
    EXPECT_EQ(opening(name), name + ": truncated HDF5 file: " + std::to_string(size / 2) + " bytes of " + std::to_string(size));
    fs::resize_file(name, 20);
    EXPECT_THAT(opening(name), testing::StartsWith(name + ": damaged HDF5 file ("));
}

TEST_F(RunReaderTest, DistinguishesOtherKindsOfFilesFromRuns) {
    H5Fclose(H5Fcreate(path("other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    EXPECT_EQ(opening(path("other.h5")), path("other.h5") + ": an HDF5 file, but not a record of a run");
    write_state(path("a.state"), SavedState{});
    EXPECT_EQ(opening(path("a.state")), path("a.state") + ": not an HDF5 file");
}

TEST_F(RunReaderTest, RefusesAFormatOfTheFuture) {
    const std::string name = example();
    without_seal(name);
    python("import h5py, sys\nf = h5py.File(sys.argv[1], \"r+\"); f.attrs[\"format_version\"] = 2", name);
    EXPECT_EQ(opening(name), name + ": format version 2 is newer than this program reads (1)");
}

TEST_F(RunReaderTest, H5pyReadsTheFileNaturally) {
    const std::string program = R"(
import h5py, sys
f = h5py.File(sys.argv[1], "r")
print(f.attrs["format"], f.attrs["status"], f.attrs["scene"], f.attrs["pins"], f.attrs["pitch"])
c = f["channels/links/tension"]
print(c.attrs["units"], "|", c.attrs["description"], c.shape, c.dtype, [(d.label, d[0].name) for d in c.dims])
print(c.dims[0]["time"] == f["channels/time"], f["channels/time"].attrs["CLASS"], f["channels/time"].attrs["units"])
print(f["channels/ratio"].shape, f["channels/ratio"].dims[0].label, f["channels/ratio"].dims[0]["time"][3])
s = f["states/y"]
print(s.shape, s.dims[0]["time"][:], s.dims[1][0].name, f["states/phases"].dtype, f["states/phases"][4])
t = f["tables/transitions"]
print(t.dtype.names, t["pin"], t["pin"].dtype, list(t.attrs["units"]), list(t.attrs["descriptions"]), t.attrs["description"])
)";
    EXPECT_EQ(python(program, example()),
              "b'cvtflow run' b'finished' b'baseline' 84 0.00812\n"
              "b'N' | b'tension of every link' (10, 3) float32 [('time', '/channels/time'), ('link', '/link')]\n"
              "True b'DIMENSION_SCALE' b's'\n"
              "(10,) time 0.003\n"
              "(5, 4) [0.  0.1 0.2 0.3 0.4] /unknown uint8 [4 1]\n"
              "('time', 'pin') [80 81 82] int64 [b's', b'1'] [b'when', b'which pin'] b'changes of phase'\n");
}

}  // namespace
}  // namespace cvtflow::engine
