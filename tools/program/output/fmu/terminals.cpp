#include "tools/program/output/fmu/terminals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "tools/program/text/markup.hpp"

namespace cvtflow::tools {

namespace {

struct ShaftOfInput {
    std::string_view input, shaft;
};
/// Outputs say it in their names. The ratio belongs to both shafts, so to none.
constexpr ShaftOfInput shaft_of_inputs[] = {{"clamping_driving", "shaft_1"}, {"drive_torque", "shaft_1"}, {"drive_speed", "shaft_1"},
                                            {"clamping_driven", "shaft_2"},  {"drive_angle", "shaft_1"},  {"load_torque", "shaft_2"},
                                            {"load_speed", "shaft_2"},       {"load_angle", "shaft_2"}};

struct Terminal {
    std::string_view name, description;
};
constexpr Terminal terminals[] = {{"shaft_1", "The driving shaft."}, {"shaft_2", "The driven shaft."}};

/// Its name within the terminal; empty for one that belongs elsewhere.
std::string member_name(const FmuVariable& variable, std::string_view terminal) {
    if (variable.kind == "input") {
        const auto* found = std::find_if(std::begin(shaft_of_inputs), std::end(shaft_of_inputs),
                                         [&](const ShaftOfInput& row) { return row.input == variable.source; });
        return found != std::end(shaft_of_inputs) && found->shaft == terminal ? variable.name : "";
    }
    const std::string group = std::string(terminal) + ".";
    return variable.kind == "output" && variable.name.starts_with(group) ? variable.name.substr(group.size()) : "";
}

}  // namespace

std::string terminals_text(const std::vector<FmuVariable>& variables) {
    std::string text;
    for (const Terminal& terminal : terminals) {
        std::string members;
        for (const FmuVariable& variable : variables) {
            const std::string member = member_name(variable, terminal.name);
            if (!member.empty())
                members += fmt::format("      <TerminalMemberVariable variableName=\"{}\" memberName=\"{}\" variableKind=\"signal\"/>\n",
                                       html(variable.name), html(member));
        }
        if (!members.empty())
            text += fmt::format("    <Terminal name=\"{}\" matchingRule=\"bus\" description=\"{}\">\n{}    </Terminal>\n", terminal.name,
                                terminal.description, members);
    }
    if (text.empty()) return "";
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiTerminalsAndIcons fmiVersion=\"3.0\">\n  <Terminals>\n" + text +
           "  </Terminals>\n</fmiTerminalsAndIcons>\n";
}

}  // namespace cvtflow::tools
