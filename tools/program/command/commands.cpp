#include <array>

#include "tools/program/command/command.hpp"

namespace cvtflow::tools {

std::span<const Command> commands() noexcept {
    static constexpr std::array rows{
        Command{"run", "Simulate a scene and record it", declare_run},
        Command{"resume", "Go on from a checkpoint or with a sweep, bit for bit", declare_resume},
        Command{"batch", "Run a sweep: many variants of a scene, a row of results each", declare_batch},
        Command{"table", "Show the results of a sweep as text or CSV, or count the cycles of a recorded load", declare_table},
        Command{"merge", "Join the results of all shards of a sweep", declare_merge},
        Command{"settle", "Settle a scene's geometric start and save the state for start.state", declare_settle},
        Command{"check", "Check a scene without running it; say what it is and what it will cost", declare_check},
        Command{"info", "Show what is in a record or a state file", declare_info},
        Command{"export", "Write the states of a record for other programs: pins, plates and sheaves for ParaView", declare_export},
        Command{"plot", "Draw a record, several, or a sweep: curves, orders, losses, maps; SVG, PNG or CSV", declare_plot},
        Command{"report", "Make a page of a record, several, or a sweep that opens anywhere: curves, the running chain, tables",
                declare_report},
        Command{"list", "List what there is: methods, detail, channels, scenes, executors, keys, units", declare_list},
        Command{"explain", "Explain keys of scenes and sweeps: meaning, unit, range, default, source", declare_explain},
        Command{"schema", "Print the JSON schema of scenes or sweeps, for editors", declare_schema},
        Command{"local-error", "Measure the error of a single step against its length", declare_local_error},
        Command{"method", "Show what a method is: order, stability, growth of errors within a step, its table", declare_method},
        Command{"fit", "Fit a stability polynomial to a scene's spectrum", declare_fit},
        Command{"compare", "Run methods and steps on a scene: errors, evaluations, time", declare_compare},
        Command{"spectrum", "Eigenvalues at a state: what a method has to cope with, and where it comes from", declare_spectrum},
        Command{"stability", "Regions of stability of methods, over the eigenvalues of a scene", declare_stability},
        Command{"pin-entry", "Run methods through the entry of a pin: its axial force, errors, evaluations, time in turns",
                declare_pin_entry},
        Command{"profile", "Measure schedules against each other: time, stages, synchronisation, scaling", declare_profile},
        Command{"granularity", "Measure how short tasks may be: efficiency of every executor against the length of a task",
                declare_granularity},
        Command{"newton", "Try the implicit methods: Newton's convergence, cost and error by variant and step", declare_newton},
        Command{"detail", "Compare levels of detail: what each dial costs and what it changes", declare_detail},
        Command{"tradeoff", "Measure what accuracy costs: methods and steps, the Pareto front, a recommendation", declare_tradeoff},
        Command{"tune", "Find the cheapest detail, method and step for a wanted accuracy, by measuring", declare_tune},
        Command{"extremes", "Run the edges of every parameter and say what comes of each", declare_extremes},
        Command{"lottery", "Run machines drawn by chance with defaults and count how they end", declare_lottery},
        Command{"export-fmu", "Write a scene as an FMU for other simulators (FMI 2.0 or 3.0)", declare_export_fmu},
        Command{"dot", "Draw the task graph of a step in Graphviz' language", declare_dot},
    };
    return rows;
}

}  // namespace cvtflow::tools
