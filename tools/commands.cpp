#include <array>

#include "tools/command.hpp"

namespace cvtflow::tools {

std::span<const Command> commands() noexcept {
    static constexpr std::array rows{
        Command{"run", "Simulate a scene and record it", declare_run},
        Command{"settle", "Settle a scene's geometric start and save the state for start.state", declare_settle},
        Command{"check", "Check a scene without running it; say what it is and what it will cost", declare_check},
        Command{"info", "Show what is in a record or a state file", declare_info},
        Command{"list", "List what there is: methods, detail, channels, scenes, executors, keys, units", declare_list},
        Command{"explain", "Explain keys of scenes: meaning, unit, range, default, source", declare_explain},
        Command{"schema", "Print the JSON schema of scenes, for editors", declare_schema},
        Command{"local-error", "Measure the error of a single step against its length", declare_local_error},
        Command{"profile", "Measure schedules against each other: time, stages, synchronisation, scaling", declare_profile},
        Command{"extremes", "Run the edges of every parameter and say what comes of each", declare_extremes},
        Command{"dot", "Draw the task graph of a step in Graphviz' language", declare_dot},
    };
    return rows;
}

}  // namespace cvtflow::tools
