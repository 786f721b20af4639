#pragma once
/// A sweep that takes a second, and what its folder holds.

#include <map>
#include <random>
#include <string>
#include <vector>

#include "engine/record/case_table.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::tools {

class Sweeps : public Program {
protected:
    /// Writes sweep.toml: `torques` x 4 cases of tiny, which settle for 20 us and run for `until`.
    void write_sweep(const std::string& torques = "\"6 N*m\", \"12 N*m\", \"18 N*m\"", const std::string& until = "40 us",
                     const std::string& more = "") const;
    Outcome batch(const std::vector<std::string>& more = {}) const;
    [[nodiscard]] engine::CaseTable table(const std::string& folder = "out") const;
    /// After "results hash" in what a command printed.
    [[nodiscard]] static std::string hash_in(const std::string& text);
    /// Text of a column by case.
    [[nodiscard]] std::map<long, std::string> column(const std::string& name, const std::string& folder = "out") const;
    /// Runs a line of bash in the test's folder; $CVTFLOW is the program.
    Outcome shell(const std::string& line) const;
};

}  // namespace cvtflow::tools
