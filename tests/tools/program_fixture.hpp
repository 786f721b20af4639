#pragma once
/// Runs a program like a user: as a child process, in a separate folder. It is cvtflow-lab where that has the command, else cvtflow.

#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <map>
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

/// Setting that loads the library before a child's program, by a name without blanks, at which the loader splits.
[[nodiscard]] std::string preload(const std::filesystem::path& library);

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

/// A run of tiny for 0.2 ms, 4,000 steps, after settling for 0.1 ms: long enough to be ended at any moment. @param record  its file
[[nodiscard]] Words run_to_be_ended(const std::string& record);

/// Each test has an empty working directory. It is the same one for all tests of a process, which run one after the other.
class Program : public testing::Test {
protected:
    Program();
    ~Program() override;

    Outcome run(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {}) const;
    /// Makes files of a fixture: the first test of a process that needs them makes them in its folder, the others get copies.
    void made_once(const std::string& files, const std::function<void()>& make) const;
    void write(const std::string& name, const std::string& text) const;
    [[nodiscard]] std::string read(const std::string& name) const;
    [[nodiscard]] bool exists(const std::string& name) const;
    [[nodiscard]] engine::RunReader record(const std::string& name) const { return engine::RunReader((folder_ / name).string()); }
    /// Hash after "state hash" in the output of a command.
    [[nodiscard]] static std::string hash_in(const std::string& text, const std::string& name = "state hash");

    std::filesystem::path folder_;
};

// A sweep that takes a second, and what its folder holds.

class Sweeps : public Program {
protected:
    /// Writes sweep.toml: `torques` x 4 cases of tiny, which settle for 20 us and run for `until`.
    void write_sweep(const std::string& torques = "\"6 N*m\", \"12 N*m\", \"18 N*m\"", const std::string& until = "40 us",
                     const std::string& more = "") const;
    /// Hash after "results hash" in the output of a command.
    [[nodiscard]] static std::string hash_in(const std::string& text) { return Program::hash_in(text, "results hash"); }
};

}  // namespace cvtflow::tools
