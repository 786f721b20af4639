/// cvtflow: the command line. Its commands, in the order of the help text.

#include <array>

#include "tools/program/program.hpp"

namespace cvtflow::tools {
namespace {

constexpr const char* run = "Commands that run a scene";
constexpr const char* sweep = "Commands for sweeps";
constexpr const char* record = "Commands for records and other programs";
constexpr const char* reference = "Commands for reference";

constexpr Action (*in_python)(CLI::App&) = nullptr;  // api/python/cvtflow/commands

constexpr std::array commands{
    Command{"run", run, "Simulate a scene and record it", declare_run},
    Command{"resume", run, "Resume a run from its checkpoint, or an unfinished sweep, bit for bit", declare_resume},
    Command{"settle", run, "Settle a scene's geometric start and save the state for start.state", declare_settle},
    Command{"check", run, "Check a scene without running it; print its size and estimated cost", declare_check},
    Command{"tune", run, "Find the cheapest detail, method and step for a target accuracy, by measuring", in_python},
    Command{"batch", sweep, "Run a sweep: many variants of a scene, one row of results each", declare_batch},
    Command{"table", sweep, "Show the results of a sweep as text or CSV, or count the cycles of a recorded load", in_python},
    Command{"diff", sweep, "Compare the results of two sweeps case by case", in_python},
    Command{"reduce", sweep, "Reduce a machine to its steady map and shift law: tables and an FMU with measured errors", in_python},
    Command{"clamp", sweep, "Find the clamping forces of best efficiency at a margin of slip, as a table for a controller", in_python},
    Command{"fit", sweep, "Adjust keys of a scene to measured values, with confidence intervals", in_python},
    Command{"info", record, "Show the contents of a record, a state file or a sweep's table", declare_info},
    Command{"plot", record, "Draw records or a sweep: curves, orders, losses, maps; SVG, PNG or CSV", in_python},
    Command{"report", record, "Write a self-contained HTML page of records or a sweep: curves, the running chain, tables", in_python},
    Command{"export", record, "Write a record for other programs: channels as CSV, pins and plates for ParaView", in_python},
    Command{"export-fmu", record, "Write a scene as an FMU for other simulators (FMI 2.0 or 3.0)", in_python},
    Command{"list", reference, "List methods, levels of detail, channels, notes, scenes, sweeps, executors, keys or units", declare_list},
    Command{"explain", reference, "Explain keys of scenes and sweeps: meaning, unit, range, default, source", declare_explain},
    Command{"schema", reference, "Print the JSON schema of scenes or sweeps, for editors", declare_schema},
};

}  // namespace
}  // namespace cvtflow::tools

int main(int argc, char** argv) {
    using namespace cvtflow::tools;
    return run_program({"cvtflow", "Dynamics of chain-driven continuously variable transmissions", commands,
                        "  cvtflow list scenes\n"
                        "  cvtflow run baseline\n"
                        "  cvtflow info results/baseline.h5",
                        "cvtflow-lab"},
                       argc, argv);
}
