#include "tools/program/command/command.hpp"

#include <array>

namespace cvtflow::tools {
namespace {

constexpr const char* run = "Commands that run a scene";
constexpr const char* sweep = "Commands for sweeps";
constexpr const char* record = "Commands for records and other programs";
constexpr const char* reference = "Commands that look things up";

}  // namespace

std::span<const Command> commands() noexcept {
    static constexpr std::array rows{
        Command{"run", run, "Simulate a scene and record it", declare_run},
        Command{"resume", run, "Go on from a checkpoint or with a sweep, bit for bit", declare_resume},
        Command{"settle", run, "Settle a scene's geometric start and save the state for start.state", declare_settle},
        Command{"check", run, "Check a scene without running it; say what it is and what it will cost", declare_check},
        Command{"tune", run, "Find the cheapest detail, method and step for a wanted run, by measuring", declare_tune},
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
    };
    return rows;
}

}  // namespace cvtflow::tools
