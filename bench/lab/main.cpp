/// cvtflow-lab: the laboratory's command line.

#include <array>

#include "bench/executor/further_executors.hpp"
#include "bench/lab/command/command.hpp"
#include "bench/method/laboratory_methods.hpp"
#include "bench/staged/staged_assembly.hpp"

namespace cvtflow::bench {
namespace {

constexpr const char* scene = "Commands about scenes, as of cvtflow, with all methods and executors";
constexpr const char* schedule = "Commands about schedules";
constexpr const char* method = "Commands about methods";
constexpr const char* accuracy = "Commands about accuracy";

/// Commands in the order of the help text.
std::span<const tools::Command> commands() noexcept {
    using tools::Command;
    static constexpr std::array rows{
        Command{"run", scene, "Run a scene", tools::declare_run},
        Command{"settle", scene, "Settle a scene and write its state", tools::declare_settle},
        Command{"check", scene, "Check a scene and estimate what its run takes", tools::declare_check},
        Command{"list", scene, "List methods, levels of detail, channels, scenes, sweeps, executors, keys or units", tools::declare_list},
        Command{"explain", scene, "Explain keys of scenes", tools::declare_explain},
        Command{"profile", schedule, "Measure schedules against each other: time, stages, synchronisation, scaling", declare_profile},
        Command{"granularity", schedule, "Measure how short tasks may be: efficiency of every executor against the length of a task",
                declare_granularity},
        Command{"executors", schedule, "List executors: those of the program and further ones to compare, and which are missing",
                declare_executors},
        Command{"run-cost", schedule, "Measure what outputs and a record cost a run over its bare steps", declare_run_cost},
        Command{"sweep-cost", schedule, "Measure a sweep against the bare loop of its steps", declare_sweep_cost},
        Command{"work", schedule, "Count the instructions of every task: what threads would gain if nothing else took time", declare_work},
        Command{"dot", schedule, "Draw the task graph of a step in Graphviz' language", declare_dot},
        Command{"method", method, "Show a method: order, stability, growth of errors within a step, table", declare_method},
        Command{"stability", method, "Draw stability regions of methods, with the eigenvalues of a scene", declare_stability},
        Command{"spectrum", method, "Compute the eigenvalues of a scene's Jacobian, and the contacts that cause them", declare_spectrum},
        Command{"local-error", method, "Measure the error of a single step against its length", declare_local_error},
        Command{"compare", accuracy, "Run methods and steps on a scene: errors, time, Newton's method, a pin's force", declare_compare},
        Command{"extremes", accuracy, "Run the edges of every parameter and say what comes of each", declare_extremes},
        Command{"lottery", accuracy, "Run machines drawn by chance with defaults and count how they end", declare_lottery},
        Command{"belt", accuracy, "Solve the theory of a continuous belt for a machine: thrust ratio, slip, shift, arcs", declare_belt},
    };
    return rows;
}

}  // namespace
}  // namespace cvtflow::bench

int main(int argc, char** argv) {
    cvtflow::bench::add_further_executors();
    cvtflow::bench::add_laboratory_methods();
    cvtflow::bench::add_staged_assembly();
    return cvtflow::tools::run_program({"cvtflow-lab", "Measures methods, schedules and runtimes of cvtflow", cvtflow::bench::commands(),
                                        "  cvtflow-lab profile baseline\n"
                                        "  cvtflow-lab compare baseline rk4@50ns leapfrog-sweep@auto\n"
                                        "  cvtflow-lab method rk4",
                                        "cvtflow"},
                                       argc, argv);
}
