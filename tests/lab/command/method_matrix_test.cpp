/// Every method through every command: a cell is done, or refused with a reason that is written here.

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <iostream>
#include <map>
#include <set>

#include "bench/method/laboratory_methods.hpp"
#include "tasks/method/method.hpp"
#include "tests/sample_fixture.hpp"
#include "tests/tools/program_fixture.hpp"

namespace cvtflow::bench {

using namespace tools;

namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

/// Expected result of a cell: its exit status and a part of its output, on stdout if it is done and on stderr if it is refused.
struct Expected {
    int status;
    std::string output;
};

/// One command line for any method.
struct Row {
    std::string command;
    std::string variant;  ///< variant of the command
    Words (*words)(const std::string& method);
    Expected (*expected)(const std::string& method);

    [[nodiscard]] std::string name() const { return command + (variant.empty() ? "" : " " + variant); }
};

const Words state{"--set", "start.state=state.h5"};
const Words outputs{"--set", "run.output_interval=1us", "--set", "run.state_interval=1us"};
constexpr int incomplete = 5;  // exit status: the table exists, and each variant without figures has its line
constexpr int unreliable = 6;
constexpr unsigned limit = 600;  // [s] of a cell; measuring the largest step of trapezoidal methods takes minutes

/// Twenty steps from the state; stops after seven with a checkpoint.
Words run_words(const std::string& method) {
    return Words{"run", "tiny", "--method", method, "--step", "100ns", "--until", "2us"} + state + outputs;
}

Expected done(const std::string& output) { return {0, output}; }

/// Euler's rule makes energy of every oscillation, with any step: its runs finish and are reported as unreliable.
Expected done_or_unreliable(const std::string& method, const std::string& output) { return {method == "euler" ? unreliable : 0, output}; }
std::string ended(const std::string& method) {
    return method == "euler" ? "tiny: unreliable at t = 2e-06 s\n" : "tiny: finished at t = 2e-06 s\n";
}

/// A program that is no table of stages.
bool is_program(const std::string& method) { return tasks::find_program(method) != nullptr; }
bool chooses_tables(const std::string& method) {
    return is_program(method) && bench::analysis_of(*tasks::find_program(method)).stability == nullptr;
}

/// Result of cvtflow only, which does not have the method.
Expected refused_or(const std::string& method, int status, const Expected& otherwise) {
    return tasks::belongs_to_laboratory(method) ? Expected{status, method + " belongs to the laboratory: cvtflow-lab run"} : otherwise;
}

/// Rows in a possible order: resume needs the file of checkpoint, table the folder of batch.
const std::vector<Row> rows{
    {"run", "",
     [](const std::string& m) {
         return run_words(m) + Words{"-o", "run.h5", "--force"};
     },
     [](const std::string& m) { return done_or_unreliable(m, ended(m)); }},
    {"info", "",
     [](const std::string&) {
         return Words{"info", "run.h5"};
     },
     [](const std::string& m) { return done("  method              " + m); }},
    {"run", "with a budget",
     [](const std::string& m) {
         return run_words(m) + Words{"-q", "-o", "cut.h5", "--force", "--checkpoint-every", "1 h", "--set", "run.max_steps=7"};
     },
     [](const std::string&) {
         return Expected{4, "the budget of 7 steps"};
     }},
    {"resume", "",
     [](const std::string&) {
         return Words{"resume", "cut.checkpoint.h5", "--set", "run.max_steps=0"};
     },
     [](const std::string& m) { return refused_or(m, 1, done_or_unreliable(m, ended(m))); }},
    {"settle", "",
     [](const std::string& m) {
         return Words{"settle", "tiny",   "--method", m, "--step", "100ns", "--time", "2us", "--set", "start.ramp_time=1us",
                      "-o",     "own.h5", "--force"} +
                outputs;
     },
     [](const std::string& m) { return done_or_unreliable(m, "tiny: settled for 2 us\n"); }},
    {"check", "", [](const std::string& m) { return Words{"check", "tiny", "--method", m, "--step", "50 ns"}; },
     [](const std::string& m) { return done(m + " with step 50 ns\n"); }},
    {"plot", "",
     [](const std::string&) {
         return Words{"plot", "run.h5", "-o", "run.svg"};
     },
     [](const std::string&) { return done("run.svg\n"); }},
    {"export-fmu", "",
     [](const std::string& m) { return Words{"export-fmu", "tiny", "--set", "run.method=" + m, "-o", "tiny.fmu", "--force"} + state; },
     [](const std::string& m) { return refused_or(m, 2, done("tiny.fmu: FMI 3.0")); }},
    {"explain", "",
     [](const std::string& m) { return Words{"explain", "run.method", "--scene", "tiny", "--set", "run.method=" + m} + state; },
     [](const std::string& m) { return done("tiny with " + m + " up to "); }},
    {"compare", "",
     [](const std::string& m) {
         return Words{"compare", "tiny",     m + "@100ns", "--reference", "rk4@50ns", "--duration", "2us", "--interval",
                      "1us",     "--rounds", "1",          "--pin",       "0",        "--newton",   "-q"} +
                state;
     },
     [](const std::string& m) { return done("\n  " + m + "@100ns "); }},
    {"local-error", "", [](const std::string& m) { return Words{"local-error", "tiny", "--methods", m, "--steps", "200ns,100ns"} + state; },
     [](const std::string& m) { return done("tiny: error of one step of " + m + " (order "); }},
    {"spectrum", "", [](const std::string& m) { return Words{"spectrum", "tiny", "--extremal", "-q", "--method", m} + state; },
     [](const std::string& m) { return done(is_program(m) ? "\n  largest stable step " : " predicted (by "); }},
    {"stability", "",
     [](const std::string& m) {
         return Words{"stability", m, "-q"};
     },
     [](const std::string& m) {
         return chooses_tables(m) ? Expected{2, m + " chooses among tables of stages: name one of them"} : done("  " + m + " ");
     }},
    {"stability", "over a scene",
     [](const std::string& m) {
         return Words{"stability", m, "--scene", "tiny", "-q"} + state;
     },
     [](const std::string& m) {
         if (chooses_tables(m)) return Expected{2, m + " chooses among tables of stages: name one of them"};
         return done(is_program(m) ? "\nLargest stable step\n  " + m + " " : " predicted (by ");
     }},
    {"method", "",
     [](const std::string& m) {
         return Words{"method", m};
     },
     [](const std::string& m) { return done(m); }},
    {"profile", "",
     [](const std::string& m) {
         return Words{"profile",  "tiny", "--method",     m,   "--step",     "100ns", "--schedules", "serial:staged", "--steps", "2",
                      "--rounds", "1",    "--neighbours", "0", "--round-ms", "1",     "-q"} +
                state;
     },
     [](const std::string&) { return done("\nWhere sequential time goes (serial:staged):\n"); }},
    {"dot", "",
     [](const std::string& m) {
         return Words{"dot", "tiny", "--method", m};
     },
     [](const std::string&) { return done("label=\"force"); }},
    {"batch", "--dry-run",
     [](const std::string&) {
         return Words{"batch", "sweep.toml", "--dry-run"};
     },
     [](const std::string& m) { return refused_or(m, 1, done("(measured on ")); }},
    {"batch", "",
     [](const std::string&) {
         return Words{"batch", "sweep.toml", "-o", "out"};
     },
     [](const std::string& m) {
         return refused_or(m, 1, m == "euler" ? Expected{incomplete, ", 1 failed"} : done("  statuses            1 ok\n"));
     }},
    {"table", "",
     [](const std::string&) {
         return Words{"table", "out"};
     },
     [](const std::string& m) {
         return tasks::belongs_to_laboratory(m) ? Expected{1, "out: "} : done(m == "euler" ? " unreliable " : " ok ");
     }},
};

/// Scenes and methods on the command line, as in the help of the commands.
bool takes_a_method(const std::string& help) {
    const auto mentions = [&](const char* word) { return help.find(word) != std::string::npos; };
    return mentions("--method") || mentions("METHOD") || mentions("run.method") || mentions("--set ") || mentions("SWEEP") ||
           mentions("Checkpoint of a run");
}

class MatrixOfMethods : public Program {
protected:
    MatrixOfMethods() { run({"settle", "tiny", "-q", "-o", "state.h5", "--time", "20us", "--set", "start.ramp_time=10us"}); }

    /// Runs one cell. @return "ok", "refused: …" or the defect
    std::string cell(const Row& row, const std::string& method) const {
        const Outcome outcome = Child(row.words(method), folder_, {}, limit).wait();
        const Expected expected = row.expected(method);
        const bool ran = expected.status == 0 || expected.status == unreliable;
        const std::string& where = ran ? outcome.out : outcome.err;
        EXPECT_EQ(outcome.status, expected.status) << row.name() << " with " << method << "\n" << outcome.err;
        EXPECT_THAT(where, HasSubstr(expected.output)) << row.name() << " with " << method << "\n" << outcome.err;
        EXPECT_THAT(outcome.out, testing::Not(ContainsRegex("[ -]nan|[ -]inf[ \n]"))) << row.name() << " with " << method;
        if (!ran && expected.status != incomplete) {
            const std::ptrdiff_t warnings = outcome.err.find(" is beyond what ") != std::string::npos ? 1 : 0;  // 100 ns is, with euler
            EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1 + warnings) << outcome.err;
            EXPECT_EQ(outcome.out, "") << row.name() << " with " << method;
        }
        const bool right = outcome.status == expected.status && where.find(expected.output) != std::string::npos;
        return !right                          ? "WRONG"
               : expected.status == unreliable ? "unreliable"
               : ran                           ? "ok"
                                               : "refused: " + outcome.err.substr(0, outcome.err.find('\n'));
    }

    /// All commands with one method.
    void try_all(const std::string& method, std::map<std::string, int>& endings) const {
        write("sweep.toml", "[sweep]\nscene = \"tiny\"\n[set]\nrun.method = \"" + method +
                                "\"\nrun.step = \"100 ns\"\nrun.until = \"2 us\"\nrun.output_interval = \"1 us\"\n"
                                "run.state_interval = \"1 us\"\nstart.settling_time = \"2 us\"\nstart.ramp_time = \"1 us\"\n[[axes]]\nkey "
                                "= \"load.torque\"\nvalues = [\"12 N*m\"]\n"
                                "[outputs]\nscalars = [\"slip mean\"]\n[start]\nmode = \"settle\"\n");
        std::filesystem::remove_all(folder_ / "out");
        for (const Row& row : rows) ++endings[row.name() + " | " + cell(row, method)];
    }
};
class NightlyMatrixOfMethods : public MatrixOfMethods {};

/// All but that of rigid pins, which no scene with pin halves takes (RigidPins.*, RigidLeapfrog.*).
std::vector<std::string> methods_of_halves() {
    std::vector<std::string> methods = tasks::method_names();
    std::erase(methods, "leapfrog-rigid");
    return methods;
}

/// One method of each family (the letters that its name begins with), tables or programs: these differ most in how they are made and run.
std::vector<std::string> one_of_each_family(bool programs) {
    std::set<std::string> families;
    std::vector<std::string> methods;
    for (const std::string& method : methods_of_halves()) {
        const auto end = std::find_if(method.begin(), method.end(), [](unsigned char c) { return std::isalpha(c) == 0; });
        if (is_program(method) == programs && families.insert(std::string(method.begin(), end)).second) methods.push_back(method);
    }
    return methods;
}

/// Commands that are not in it, and why.
const std::map<std::string, std::string> finds_methods{{"tune", "tries every method by itself, whatever the scene names (Tuner.*)"},
                                                       {"reduce", "runs steady sweeps with the automatic method (Reduce.*)"},
                                                       {"clamp", "runs steady sweeps with the automatic method (Reduce.*)"},
                                                       {"work", "counts instructions of a step, one by one (WorkCommand.*)"},
                                                       {"belt", "solves a theory of belts, without a method (BeltCommand.*)"},
                                                       {"sweep-cost", "runs sweeps, whose scenes name the method (SweepCostCommand.*)"},
                                                       {"run-cost", "runs a scene with its own method, as run does (RunCostCommand.*)"},
                                                       {"noise", "takes the automatic method of two levels of detail (NoiseCommand.*)"}};

TEST_F(MatrixOfMethods, HoldsEveryCommandThatTakesAMethod) {
    std::set<std::string> in_matrix;
    for (const Row& row : rows) in_matrix.insert(row.command);
    const Words all = commands_of(CVTFLOW_PROGRAM) + commands_of(CVTFLOW_LAB);
    for (const std::string& command : all)
        EXPECT_TRUE(in_matrix.contains(command) || finds_methods.contains(command) || !takes_a_method(run({command, "--help"}).out))
            << command;
    EXPECT_GT(all.size(), 20u);
}

TEST_F(MatrixOfMethods, IsDoneForTables) {
    std::map<std::string, int> endings;
    for (const std::string& method : cvtflow::test::sample(one_of_each_family(false), 1, "tables")) try_all(method, endings);
    try_all("rk4", endings);
    for (const Row& row : rows) EXPECT_TRUE(row.expected("rk4").status == 4 || endings.contains(row.name() + " | ok")) << row.name();
}

TEST_F(MatrixOfMethods, IsDoneOrRefusedWithAReasonForPrograms) {
    std::map<std::string, int> endings;
    std::vector<std::string> others = one_of_each_family(true);
    const auto refused = std::find_if(others.begin(), others.end(), chooses_tables);  // in every sample: cells of the others are all done
    ASSERT_NE(refused, others.end());
    try_all(*refused, endings);
    EXPECT_TRUE(std::any_of(endings.begin(), endings.end(),
                            [](const auto& ending) { return ending.first.find("| refused: ") != std::string::npos; }));
    others.erase(refused);
    for (const std::string& method : cvtflow::test::sample(others, 1, "programs")) try_all(method, endings);
}

TEST_F(NightlyMatrixOfMethods, IsDoneOrRefusedWithAReasonForAll) {
    std::map<std::string, int> endings;
    for (const std::string& method : methods_of_halves()) try_all(method, endings);
    for (const auto& [ending, count] : endings)
        std::cout << count << " of " << methods_of_halves().size() << " methods: " << ending << "\n";
}

}  // namespace
}  // namespace cvtflow::bench
