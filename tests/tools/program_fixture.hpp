#pragma once
/// Runs a program like a user: as a child process, in a separate folder. It is cvtflow-lab where that has the command, else cvtflow.

#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "engine/record/run/run_reader.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::tools {

struct Outcome {
    int status = 0;   ///< exit status; 128 + signal if one ended it
    std::string out;  ///< stdout
    std::string err;  ///< stderr
};

using Words = std::vector<std::string>;  ///< words of a command line

/// One list after the other.
[[nodiscard]] inline Words operator+(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// Every command of a program, as its help lists them.
[[nodiscard]] Words commands_of(const std::string& program);

/// The program for these words: cvtflow, or cvtflow-lab where that alone has the command, or a method or executor that they name. A build
/// without the laboratory (CVTFLOW_LAB is not defined) has cvtflow only.
[[nodiscard]] std::string program_of(const Words& words);
/// First word of commands for the laboratory's program, which has some of the other one's commands.
inline constexpr const char* laboratory = "cvtflow-lab";

/// A child process; killed when it goes out of scope.
class Child {
public:
    /// @param environment "NAME=value", added to this process's   @param seconds after which a signal ends it; 0: never
    Child(std::vector<std::string> arguments, const std::filesystem::path& folder, const std::vector<std::string>& environment = {},
          unsigned seconds = 0);
    ~Child();
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    [[nodiscard]] Outcome wait();

private:
    std::filesystem::path out_, err_;
    pid_t process_ = -1;
};

/// --set and each of these settings.
[[nodiscard]] Words set_all(const Words& settings);

/// Options that settle a scene just enough for commands that require a settled state.
inline const std::vector<std::string> brief_settling{
    "--settle", "--set", "start.settling_time=1ms", "--set", "start.ramp_time=0.5ms", "--set", "run.step=50 ns"};

/// Each test has an empty working directory. It is the same one for all tests of a process, which run one after the other.
class Program : public testing::Test {
protected:
    Program();
    ~Program() override;

    Outcome run(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {}) const;
    void write(const std::string& name, const std::string& text) const;
    [[nodiscard]] std::string read(const std::string& name) const;
    [[nodiscard]] bool exists(const std::string& name) const;
    [[nodiscard]] engine::RunReader record(const std::string& name) const { return engine::RunReader((folder_ / name).string()); }
    std::filesystem::path folder_;
};

}  // namespace cvtflow::tools
