#include "tools/program/command/command.hpp"

#include <array>

namespace cvtflow::tools {
namespace {

constexpr const char* run = "Commands that run a scene";
constexpr const char* sweep = "Commands for sweeps";
constexpr const char* record = "Commands for records and other programs";
constexpr const char* reference = "Commands that look things up";
constexpr const char* accuracy = "Commands that choose detail, method and step";
constexpr const char* method = "Commands about methods";
constexpr const char* schedule = "Commands about schedules";

}  // namespace

std::span<const Command> commands() noexcept {
    static constexpr std::array rows{
        Command{"run", run, "Simulate a scene and record it", declare_run},
        Command{"resume", run, "Go on from a checkpoint or with a sweep, bit for bit", declare_resume},
        Command{"settle", run, "Settle a scene's geometric start and save the state for start.state", declare_settle},
        Command{"check", run, "Check a scene without running it; say what it is and what it will cost", declare_check},
        Command{"batch", sweep, "Run a sweep: many variants of a scene, a row of results each", declare_batch},
        Command{"table", sweep, "Show the results of a sweep as text or CSV, or count the cycles of a recorded load", declare_table},
        Command{"merge", sweep, "Join the results of all shards of a sweep", declare_merge},
        Command{"info", record, "Show what is in a record or a state file", declare_info},
        Command{"plot", record, "Draw a record, several, or a sweep: curves, orders, losses, maps; SVG, PNG or CSV", declare_plot},
        Command{"report", record, "Make a page of a record, several, or a sweep that opens anywhere: curves, the running chain, tables",
                declare_report},
        Command{"export", record, "Write a record for other programs: channels as CSV, pins and plates for ParaView", declare_export},
        Command{"export-fmu", record, "Write a scene as an FMU for other simulators (FMI 2.0 or 3.0)", declare_export_fmu},
        Command{"list", reference, "List what there is: methods, detail, channels, scenes, executors, keys, units", declare_list},
        Command{"explain", reference, "Explain keys of scenes and sweeps: meaning, unit, range, default, source", declare_explain},
        Command{"schema", reference, "Print the JSON schema of scenes or sweeps, for editors", declare_schema},
        Command{"tune", accuracy, "Find the cheapest detail, method and step for a wanted accuracy, by measuring", declare_tune},
        Command{"tradeoff", accuracy, "Measure what accuracy costs: methods and steps, the Pareto front, a recommendation",
                declare_tradeoff},
        Command{"detail", accuracy, "Compare levels of detail: what each dial costs and what it changes", declare_detail},
        Command{"compare", accuracy, "Run methods and steps on a scene: errors, evaluations, time", declare_compare},
        Command{"extremes", accuracy, "Run the edges of every parameter and say what comes of each", declare_extremes},
        Command{"lottery", accuracy, "Run machines drawn by chance with defaults and count how they end", declare_lottery},
        Command{"method", method, "Show what a method is: order, stability, growth of errors within a step, its table", declare_method},
        Command{"stability", method, "Regions of stability of methods, over the eigenvalues of a scene", declare_stability},
        Command{"spectrum", method, "Eigenvalues at a state: what a method has to cope with, and where it comes from", declare_spectrum},
        Command{"fit", method, "Fit a stability polynomial to a scene's spectrum", declare_fit},
        Command{"local-error", method, "Measure the error of a single step against its length", declare_local_error},
        Command{"pin-entry", method, "Run methods through the entry of a pin: its axial force, errors, evaluations, time in turns",
                declare_pin_entry},
        Command{"newton", method, "Try the implicit methods: Newton's convergence, cost and error by variant and step", declare_newton},
        Command{"profile", schedule, "Measure schedules against each other: time, stages, synchronisation, scaling", declare_profile},
        Command{"granularity", schedule, "Measure how short tasks may be: efficiency of every executor against the length of a task",
                declare_granularity},
        Command{"dot", schedule, "Draw the task graph of a step in Graphviz' language", declare_dot},
    };
    return rows;
}

}  // namespace cvtflow::tools
