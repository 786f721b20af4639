#include "tools/program/output/fmu/model_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <variant>

#include "engine/base/provenance.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/text/markup.hpp"

namespace cvtflow::tools {

namespace {

std::string number(double value) { return fmt::format("{}", value); }  // reads back as the same double

/// ` name="value"`; nothing for an empty one.
std::string attribute(const char* name, const std::string& value) {
    return value.empty() ? "" : fmt::format(" {}=\"{}\"", name, html(value));
}

/// Unit, the one to display, range and order of magnitude; nothing for what a variable does not have. Pure numbers have no unit.
std::string type_attributes(const FmuVariable& row) {
    std::string text = attribute("unit", row.unit == "1" ? "" : row.unit) + attribute("displayUnit", row.display_unit);
    if (row.min) text += attribute("min", number(*row.min)) + attribute("max", number(*row.max));
    return text + (row.nominal > 0.0 ? attribute("nominal", number(row.nominal)) : "");
}

/// Of units of channels, too, which scenes do not know.
tasks::Dimension dimension_of(const std::string& unit) {
    if (unit == "J") return tasks::dimension_of("N*m");
    if (unit == "W") return tasks::dimension_of("N*m/s");
    return tasks::dimension_of(unit);
}

/// Units in use with their exponents of kg, m, s, rad, and what people use; those with halves go without exponents.
std::string unit_definitions(const std::vector<FmuVariable>& variables) {
    std::map<std::string, std::string> display_units;
    for (const FmuVariable& row : variables) {
        if (row.unit != "1") display_units[row.unit] = row.display_unit;
    }
    std::string text = "  <UnitDefinitions>\n";
    for (const auto& [name, display] : display_units) {
        const tasks::Dimension d = dimension_of(name);
        text += fmt::format("    <Unit name=\"{}\">", html(name));
        if ((d.mass | d.length | d.time | d.angle) % 2 == 0)
            text += fmt::format("<BaseUnit kg=\"{}\" m=\"{}\" s=\"{}\" rad=\"{}\"/>", d.mass / 2, d.length / 2, d.time / 2, d.angle / 2);
        if (!display.empty()) {
            const double size = std::get<tasks::Quantity>(tasks::parse_quantity("1 " + display)).value;
            text += fmt::format("<DisplayUnit name=\"{}\" factor=\"{}\"/>", html(display), number(1.0 / size));
        }
        text += "</Unit>\n";
    }
    return text + "  </UnitDefinitions>\n";
}

std::string head(const FmuFacts& facts, const char* version, const char* token) {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"{}\" modelName=\"{}\" {}=\"{}\" description=\"{}\" "
        "generationTool=\"cvtflow {}\"{}{} variableNamingConvention=\"structured\">\n",
        version, html(facts.name), token, facts.token, html(facts.description), engine::current_provenance().version,
        attribute("author", facts.author), attribute("generationDateAndTime", facts.date));
}

/// Of the default experiment, which importers take unasked: long enough for a call to cost little beside the steps that it takes. [s]
double communication_step(double until) { return until >= 0.05 ? 1e-3 : std::min(1e-4, until); }

std::string middle(const FmuFacts& facts, const std::vector<FmuVariable>& variables) {
    std::string text = unit_definitions(variables) + "  <LogCategories>\n";
    for (const char* category : {"logStatusError", "logStatusWarning"}) text += fmt::format("    <Category name=\"{}\"/>\n", category);
    return text + fmt::format("  </LogCategories>\n  <DefaultExperiment startTime=\"0\" stopTime=\"{}\" stepSize=\"{}\"/>\n",
                              number(facts.until), number(communication_step(facts.until)));
}

/// Attributes that both versions give a variable.
std::string causality(const FmuVariable& row) {
    const bool parameter = row.kind == "parameter";
    return fmt::format("name=\"{}\" valueReference=\"{}\" causality=\"{}\" variability=\"{}\" description=\"{}\"", html(row.name),
                       row.reference, row.kind == "time" ? "independent" : row.kind, parameter ? "fixed" : "continuous",
                       html(row.description));
}

std::string start_attribute(const FmuVariable& row) {
    return row.kind == "input" || row.kind == "parameter" ? fmt::format(" start=\"{}\"", number(row.start)) : "";
}

}  // namespace

std::string model_description_2(const FmuFacts& facts, const std::vector<FmuVariable>& variables) {
    std::string text = head(facts, "2.0", "guid");
    text += fmt::format(
        "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"true\" canGetAndSetFMUstate=\"true\" "
        "canSerializeFMUstate=\"true\"/>\n",
        facts.identifier);
    text += middle(facts, variables) + "  <ModelVariables>\n";
    std::string unknowns;
    for (std::size_t index = 0; index < variables.size(); ++index) {
        const FmuVariable& row = variables[index];
        text += fmt::format("    <ScalarVariable {}><Real{}{}/></ScalarVariable>\n", causality(row), start_attribute(row),
                            type_attributes(row));
        if (row.kind == "output") unknowns += fmt::format("      <Unknown index=\"{}\"/>\n", index + 1);
    }
    return text + fmt::format(
                      "  </ModelVariables>\n  <ModelStructure>\n    <Outputs>\n{0}    </Outputs>\n    <InitialUnknowns>\n{0}    "
                      "</InitialUnknowns>\n  </ModelStructure>\n</fmiModelDescription>\n",
                      unknowns);
}

std::string model_description_3(const FmuFacts& facts, const std::vector<FmuVariable>& variables) {
    std::string text = head(facts, "3.0", "instantiationToken");
    text += fmt::format(
        "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"true\" canGetAndSetFMUState=\"true\" "
        "canSerializeFMUState=\"true\" providesIntermediateUpdate=\"true\" mightReturnEarlyFromDoStep=\"true\" "
        "canReturnEarlyAfterIntermediateUpdate=\"true\"/>\n",
        facts.identifier);
    text += middle(facts, variables) + "  <ModelVariables>\n";
    std::string outputs, initial;
    for (const FmuVariable& row : variables) {
        const std::string dimension = row.width > 1 ? fmt::format("<Dimension start=\"{}\"/>", row.width) : "";
        text += fmt::format("    <Float64 {}{}{}>{}</Float64>\n", causality(row), start_attribute(row), type_attributes(row), dimension);
        if (row.kind != "output") continue;
        outputs += fmt::format("    <Output valueReference=\"{}\"/>\n", row.reference);
        initial += fmt::format("    <InitialUnknown valueReference=\"{}\"/>\n", row.reference);
    }
    return text + "  </ModelVariables>\n  <ModelStructure>\n" + outputs + initial + "  </ModelStructure>\n</fmiModelDescription>\n";
}

namespace {

struct ShaftOfInput {
    std::string_view input, shaft;
};
/// Outputs say it in their names. The ratio belongs to both shafts, so to none.
constexpr ShaftOfInput shaft_of_inputs[] = {{"clamping_driving", "shaft_1"}, {"drive_torque", "shaft_1"}, {"drive_speed", "shaft_1"},
                                            {"clamping_driven", "shaft_2"},  {"drive_angle", "shaft_1"},  {"load_torque", "shaft_2"},
                                            {"load_speed", "shaft_2"},       {"load_angle", "shaft_2"},   {"pressure_driving", "shaft_1"},
                                            {"pressure_driven", "shaft_2"}};

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
