#include <gtest/gtest.h>

#include <fstream>
#include <string_view>

#include "engine/record/hdf5/file_seal.hpp"
#include "engine/record/hdf5/hdf5_open.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

using FileSealTest = RecordTest;

TEST_F(FileSealTest, BreaksWithEveryBit) {
    const std::string name = path("sealed");
    const std::string text = "some bytes, some more, and a seal behind them";
    std::ofstream(name) << text;
    seal_anew(name);
    ASSERT_EQ(inspect_seal(InputFile(name)), Seal::whole);
    const std::string good = read_text_file(name);
    ASSERT_EQ(good.size(), text.size() + seal_size);
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        std::string bad = good;
        bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
        std::ofstream(name) << bad;
        EXPECT_EQ(inspect_seal(InputFile(name)), bit / 8 < text.size() ? Seal::broken : Seal::none) << bit;
    }
    for (std::size_t size = 0; size < good.size(); ++size) {
        std::ofstream(name) << good.substr(0, size);
        EXPECT_EQ(inspect_seal(InputFile(name)), Seal::none);
    }
    std::ofstream(name) << text.substr(1) << good.substr(text.size());
    EXPECT_EQ(inspect_seal(InputFile(name)), Seal::broken);
}

TEST_F(FileSealTest, IsOnFinishedRecordsAndOnInterruptedOnes) {
    {
        RunFile file(path("out.h5"), example_contents());
        append_example(file, 0);
        file.flush();
        EXPECT_FALSE(RunReader(path("out.h5.part")).sealed());  // being written
        file.close();
    }
    EXPECT_TRUE(RunReader(path("out.h5")).sealed());
    { RunFile file(path("cut.h5"), example_contents()); }
    EXPECT_TRUE(RunReader(path("cut.h5.part")).sealed());
    without_seal(path("out.h5"));
    EXPECT_FALSE(RunReader(path("out.h5")).sealed());
    EXPECT_EQ(RunReader(path("out.h5")).rows(), 1U);  // readable all the same: what h5py or h5repack made of a record has none
}

TEST_F(FileSealTest, KeepsABrokenRecordFromTheLibrary) {
    {
        RunFile file(path("out.h5"), example_contents());
        file.close();
    }
    std::string bytes = read_text_file(path("out.h5"));
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    std::ofstream(path("out.h5")) << bytes;
    EXPECT_EQ(error_of([&] { RunReader reader(path("out.h5")); }),
              path("out.h5") + ": damaged HDF5 file (changed after it was finished: its checksum differs)");
}

}  // namespace
}  // namespace cvtflow::engine

namespace cvtflow::engine::hdf5 {
namespace {

TEST(Hdf5Handle, PrintsNothingWhereItCannotBeClosed) {
    hdf5::Handle handle(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "");
    ASSERT_GE(H5Pclose(handle.id()), 0);
    testing::internal::CaptureStderr();
    handle.release();
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace cvtflow::engine::hdf5
