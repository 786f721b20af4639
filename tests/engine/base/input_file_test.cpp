#include "engine/base/input_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "tests/engine/record/record_fixture.hpp"

namespace cvtflow::engine {
namespace {

using InputFileTest = RecordTest;

std::string refusal(const std::string& path, std::uint64_t most = 1'000'000, double timeout = 10.0) {
    try {
        (void)read_text_input(path, most, timeout);
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

TEST_F(InputFileTest, IsReadCompletely) {
    const std::string text(100'000, 'x');
    std::ofstream(path("text")) << text;
    EXPECT_EQ(read_text_input(path("text"), 1'000'000), text);
}

TEST_F(InputFileTest, LosesItsByteOrderMark) {
    std::ofstream(path("text")) << "\xEF\xBB\xBFkey = 1\n";
    EXPECT_EQ(read_text_input(path("text"), 1'000'000), "key = 1\n");
}

TEST_F(InputFileTest, MayBeNoPipeNoDeviceAndNoFolder) {
    ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
    EXPECT_EQ(refusal(path("pipe")), "not a regular file");  // without a writer, opening it would wait for ever
    EXPECT_EQ(refusal("/dev/zero"), "not a regular file");
    EXPECT_EQ(refusal(path("")), "a folder, not a file");
    EXPECT_EQ(refusal(path("absent")), "No such file or directory");
}

TEST_F(InputFileTest, MayComeThroughAPipeWithoutAName) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const std::string name = "/dev/fd/" + std::to_string(ends[0]);
    EXPECT_EQ(refusal(name, 5, 0.01), "nothing came for 0 s");  // a writer that is silent
    ASSERT_EQ(write(ends[1], "12345", 5), 5);
    close(ends[1]);
    EXPECT_EQ(read_text_input(name, 5), "12345");
    EXPECT_EQ(read_text_input(name, 5), "");  // taken out of it
    close(ends[0]);
    ASSERT_EQ(pipe(ends), 0);
    ASSERT_EQ(write(ends[1], "12345", 5), 5);
    EXPECT_EQ(refusal("/dev/fd/" + std::to_string(ends[0]), 4), "more than the 4 bytes that such a file may have");
    close(ends[0]);
    close(ends[1]);
}

TEST_F(InputFileTest, HasALimitedSizeAlsoIfItDoesNotTellIt) {
    std::ofstream(path("text")) << "12345";
    EXPECT_EQ(refusal(path("text"), 5), "none");
    EXPECT_EQ(refusal(path("text"), 4), "5 bytes, more than the 4 that such a file may have");
    EXPECT_EQ(refusal("/proc/self/status", 4), "more than the 4 bytes that such a file may have");  // its size is said to be 0
}

}  // namespace
}  // namespace cvtflow::engine
