#pragma once
/// A separate folder for every test, child processes to be killed, and the run that the tests of the record write.

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>

#include "engine/record/run/run_file.hpp"

namespace cvtflow::engine {

class RecordTest : public testing::Test {
protected:
    RecordTest();
    ~RecordTest() override;

    [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
    /// Output of /usr/bin/python3 running a program with one argument; the tests need h5py.
    static std::string python(const std::string& program, const std::string& argument);

private:
    std::filesystem::path folder_;
};

/// Two scalars and one channel of width 3 in a group, states of 4 with 2 phases, one table.
[[nodiscard]] RunContents example_contents();
/// Row number i of the example: time i/1000, values i, -i, and 10 i + 0, 1, 2.
void append_example(RunFile& file, int i);
/// State number i: time i/10, unknowns i + 0.25, …, phases i % 256 and 1.
void append_example_state(RunFile& file, int i);

/// The message of the RecordError that the call throws; "no error" otherwise.
[[nodiscard]] std::string error_of(const std::function<void()>& call);

/// Runs the body in a child process that exits with 0, or with 1 after an exception. @return its process number
[[nodiscard]] int start_child(const std::function<void()>& body);
/// Waits for a child. @return exit status as the shell counts it, 128 + signal for a killed one
int wait_for(int child);
/// Removes the seal of a finished file.
void without_seal(const std::string& path);
/// Adds a seal for the present contents of a file.
void seal_anew(const std::string& path);
[[nodiscard]] std::string read_text_file(const std::string& path);

}  // namespace cvtflow::engine
