#pragma once
/// Runs a program like a user: as a child process, in a separate folder. It is cvtflow-lab where that has the command, else cvtflow.

#include <gtest/gtest.h>
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "engine/record/case_table.hpp"
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

/// Waits until `condition` holds. @return whether it did within 20 s
template <class Condition>
bool eventually(const Condition& condition) {
    using namespace std::chrono_literals;
    for (int attempt = 0; attempt < 10000; ++attempt) {
        if (condition()) return true;
        std::this_thread::sleep_for(2ms);
    }
    return false;
}

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

    void send(int signal) const;
    [[nodiscard]] pid_t id() const noexcept { return process_; }
    [[nodiscard]] Outcome wait();
    /// The only child, if any: the process that runs the cases of a sweep. 0: none
    [[nodiscard]] pid_t worker() const;
    /// Waits for the condition and sends a signal then, or lets the child end before.
    template <class Condition>
    Outcome ended_when(const Condition& condition, int signal) {
        EXPECT_TRUE(eventually([&] { return has_ended() || condition(); }));
        send(signal);
        return wait();
    }

private:
    [[nodiscard]] bool has_ended() const;

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
    /// run() with the scene tiny, settling and running for 20 us; a fraction of a second.
    Outcome run_briefly(const std::vector<std::string>& more = {}) const;
    /// Output of run() on a terminal of that width, stdout included.
    [[nodiscard]] std::string draw(const std::vector<std::string>& arguments, int columns) const;
    /// Makes files of a fixture: the first test of a process that needs them makes them in its folder, the others get copies.
    void made_once(const std::string& files, const std::function<void()>& make) const;
    void write(const std::string& name, const std::string& text) const;
    [[nodiscard]] std::string read(const std::string& name) const;
    [[nodiscard]] bool exists(const std::string& name) const;
    /// Copies the first `bytes` of a file.
    void cut(const std::string& from, const std::string& to, std::size_t bytes) const;
    [[nodiscard]] engine::RunReader record(const std::string& name) const { return engine::RunReader((folder_ / name).string()); }
    /// Number of rows of a record that is being written, or of the table of a sweep; 0 before it can be read.
    [[nodiscard]] std::size_t rows_of(const std::string& file) const;
    /// Hash after "state hash" in the output of a command.
    [[nodiscard]] static std::string hash_in(const std::string& text, const std::string& name = "state hash");

    std::filesystem::path folder_;
};

/// Hash of the last state, stated by a record.
[[nodiscard]] std::string recorded_hash(const std::filesystem::path& record);

// A sweep that takes a second, and what its folder holds.

class Sweeps : public Program {
protected:
    /// Writes sweep.toml: `torques` x 4 cases of tiny, which settle for 20 us and run for `until`.
    void write_sweep(const std::string& torques = "\"6 N*m\", \"12 N*m\", \"18 N*m\"", const std::string& until = "40 us",
                     const std::string& more = "") const;
    /// Asks for records of all cases in sweep.toml.
    void add_records() const;
    Outcome batch(const Words& more = {}) const { return run(Words{"batch", "sweep.toml", "-o", "out"} + more); }
    [[nodiscard]] engine::CaseTable table(const std::string& folder = "out") const;
    /// Hash after "results hash" in the output of a command.
    [[nodiscard]] static std::string hash_in(const std::string& text) { return Program::hash_in(text, "results hash"); }
    /// Text of a column by case.
    [[nodiscard]] std::map<long, std::string> column(const std::string& name, const std::string& folder = "out") const;
    /// Runs a line of bash in the test's folder; $CVTFLOW is the program, $SOURCE the folder of sources.
    Outcome shell(const std::string& line) const;
};

}  // namespace cvtflow::tools
