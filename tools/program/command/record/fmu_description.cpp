#include "tools/program/command/record/fmu_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <iterator>
#include <map>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/guard.hpp"
#include "tools/program/text/markup.hpp"

namespace cvtflow::tools {

namespace {

using Names = std::vector<std::string>;

/// Default outputs of an FMU. An FMU has those of them that its scene has.
constexpr std::string_view usual_outputs[] = {
    "shaft_1/speed",    "shaft_2/speed", "shaft_1/torque", "shaft_1/chain_torque", "shaft_2/chain_torque", "shaft_1/clamping",
    "shaft_2/clamping", "ratio",         "slip",           "efficiency",           "loss/total",           "balance/suspicion"};
constexpr std::string_view usual_parameters[] = {"drive.inertia",
                                                 "drive.governor_frequency",
                                                 "load.inertia",
                                                 "load.linear",
                                                 "load.quadratic",
                                                 "plate.friction_coefficient",
                                                 "joint.friction_coefficient",
                                                 "tip.friction_coefficient",
                                                 "tip.friction_scale",
                                                 "pulley.cylinder_damping",
                                                 "clamping.safety",
                                                 "control.proportional",
                                                 "control.integral"};

[[nodiscard]] bool is_in(const Names& names, std::string_view name) { return std::find(names.begin(), names.end(), name) != names.end(); }

/// The requested names; all of them for "all"; the usual ones that the scene has if none is requested. @param known  all that may be
/// requested
Names chosen(const char* option, const Names& requested, const Names& known, const Names& all, std::span<const std::string_view> usual) {
    if (requested == Names{"all"}) return all;
    for (const std::string& name : requested) {
        if (is_in(known, name)) continue;
        throw UsageError(fmt::format("{}: the scene has no '{}'{}", option, name, engine::did_you_mean(engine::closest(name, known))));
    }
    if (!requested.empty()) return requested;
    Names kept;
    for (const std::string_view name : usual) {
        if (is_in(known, name)) kept.emplace_back(name);
    }
    return kept.empty() ? all : kept;
}

/// A channel's name in the standard's structured convention.
std::string structured(std::string name) {
    std::replace(name.begin(), name.end(), '/', '.');
    return name;
}

/// 10^n nearest below the magnitude; 0 for 0.
double magnitude(double value) {
    const double size = std::abs(value);
    return size > 0.0 && std::isfinite(size) ? std::pow(10.0, std::floor(std::log10(size))) : 0.0;
}

/// Display unit of a quantity; empty if that is the SI unit, has an offset (K), or scenes do not know the unit (J, W).
std::string display_unit(const std::string& unit) {
    if (unit == "N*m" || unit == "J" || unit == "W" || unit == "K") return "";
    const auto usual = tasks::usual_units(unit);
    return usual.empty() ? "" : std::string(usual.front());
}

void add_range(FmuVariable& row, const tasks::Parameter& key) {
    row.min = key.min;
    row.max = key.max;
    row.nominal = magnitude(row.start);
    row.display_unit = display_unit(row.unit);
}

/// hydraulics.driving_pressure of pressure_driving.
bool is_pressure_of(std::string_view key, std::string_view input) {
    constexpr std::string_view group = "pressure_", section = "hydraulics_", quantity = "_pressure";
    return input.starts_with(group) && key.starts_with(section) && key.ends_with(quantity) &&
           key.substr(section.size(), key.size() - section.size() - quantity.size()) == input.substr(group.size());
}

/// The key whose table an input replaces: load.torque of load_torque, control.ratio of ratio.
const tasks::Parameter* key_of_input(std::string_view name) {
    for (const tasks::Parameter& row : tasks::parameter_table()) {
        std::string flat(row.key);
        std::replace(flat.begin(), flat.end(), '.', '_');
        if (row.kind() == tasks::Kind::time_table && (flat == name || flat == "control_" + std::string(name) || is_pressure_of(flat, name)))
            return &row;
    }
    return nullptr;
}

std::vector<FmuVariable> inputs(const Simulation& simulation, const Names& requested) {
    std::vector<FmuVariable> rows;
    Names names;
    for (int number = 0; number <= static_cast<int>(Input::pressure_driven); ++number) {
        const auto input = static_cast<Input>(number);
        const InputInfo info = input_info(input);
        try {
            rows.push_back({0, "input", std::string(info.name), std::string(info.unit), std::string(info.description), 1,
                            simulation.input(input), std::string(info.name)});
            names.emplace_back(info.name);
        } catch (const Error&) {  // not in this scene
            continue;
        }
        if (info.name == "ratio") rows.back().name = "ratio_target";  // an output has its name
        if (const tasks::Parameter* key = key_of_input(info.name)) add_range(rows.back(), *key);
    }
    std::vector<std::string_view> usual;  // an importer that sets every input would hold an angle at its start value
    std::copy_if(names.begin(), names.end(), std::back_inserter(usual), [](const std::string& name) { return !name.ends_with("_angle"); });
    const Names kept = chosen("--inputs", requested, names, names, usual);
    std::erase_if(rows, [&](const FmuVariable& row) { return !is_in(kept, row.source); });
    return rows;
}

std::vector<FmuVariable> outputs(Simulation& simulation, const Names& requested, bool arrays) {
    Names names, scalars;
    for (std::size_t index = 0; index < simulation.channels(); ++index) {
        const ChannelInfo info = simulation.channel_info(index);
        names.emplace_back(info.name);
        if (info.width == 1) scalars.emplace_back(info.name);
    }
    Names single;  // groups such as "vehicle/*" as their channels
    for (const std::string& name : requested) {
        const auto in_group = [&](const std::string& channel) { return channel.starts_with(name.substr(0, name.size() - 1)); };
        if (name.ends_with("/*") && std::any_of(names.begin(), names.end(), in_group))
            std::copy_if(names.begin(), names.end(), std::back_inserter(single), in_group);
        else
            single.push_back(name);
    }
    std::vector<FmuVariable> rows;
    for (const std::string& channel : chosen("--outputs", single, names, scalars, usual_outputs)) {
        const ChannelInfo info = simulation.channel_info(simulation.find_channel(channel));
        const std::span<const double> now = simulation.channel(channel);
        const double largest =
            std::abs(*std::max_element(now.begin(), now.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
        const std::string name = structured(channel);
        const bool whole = arrays || info.width == 1;
        for (std::size_t element = 0; element < (whole ? 1 : info.width); ++element) {
            rows.push_back({0, "output", whole ? name : fmt::format("{}[{}]", name, element), std::string(info.unit),
                            std::string(info.description), whole ? info.width : 1, 0.0, channel, element});
            rows.back().nominal = magnitude(largest);
            rows.back().display_unit = display_unit(rows.back().unit);
        }
    }
    return rows;
}

/// Numbers of the machine. Keys that determine the size of the state, the method or the run remain as exported, as do those that follow.
std::vector<FmuVariable> parameters(const Scene& scene, const Names& requested) {
    Names keys;
    const tasks::Scene read = tasks::parse_scene(scene.text(), scene.name(), tasks::StartState::recorded);
    for (const tasks::Parameter& row : tasks::parameter_table()) {
        const bool is_number = row.kind() == tasks::Kind::number && !tasks::is_derived(read, row.key);
        if (is_number && row.section() != "run" && row.section() != "start") keys.emplace_back(row.key);
    }
    std::vector<FmuVariable> rows;
    for (const std::string& key : chosen("--parameters", requested, keys, keys, usual_parameters)) {
        const tasks::Parameter& row = *tasks::find_parameter(key);
        rows.push_back(
            {0, "parameter", key, std::string(row.unit), std::string(row.meaning), 1, engine::number_of(scene.value(key)).value(), key});
        add_range(rows.back(), row);
    }
    return rows;
}

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

/// Dimension of a unit, also of units of channels that scenes do not have.
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

/// Communication step of the default experiment, which importers use by default: that of vehicles, whose controllers run every 1 to 10 ms;
/// shorter for transients of the chain alone. [s]
double communication_step(const FmuFacts& facts) { return std::min(facts.vehicle || facts.until >= 0.05 ? 1e-3 : 1e-4, facts.until); }

std::string middle(const FmuFacts& facts, const std::vector<FmuVariable>& variables) {
    std::string text = unit_definitions(variables) + "  <LogCategories>\n";
    for (const char* category : {"logStatusError", "logStatusWarning"}) text += fmt::format("    <Category name=\"{}\"/>\n", category);
    return text + fmt::format("  </LogCategories>\n  <DefaultExperiment startTime=\"0\" stopTime=\"{}\" stepSize=\"{}\"/>\n",
                              number(facts.until), number(communication_step(facts)));
}

bool is_output(const FmuVariable& row) { return row.kind == "output" || row.kind == "flag"; }

/// Attributes that both versions give a variable.
std::string causality(const FmuVariable& row) {
    const char* variability = row.kind == "parameter" ? "fixed" : row.kind == "flag" ? "discrete" : "continuous";
    return fmt::format("name=\"{}\" valueReference=\"{}\" causality=\"{}\" variability=\"{}\" description=\"{}\"", html(row.name),
                       row.reference,
                       row.kind == "time" ? "independent"
                       : is_output(row)   ? "output"
                                          : row.kind,
                       variability, html(row.description));
}

std::string start_attribute(const FmuVariable& row) {
    return row.kind == "input" || row.kind == "parameter" ? fmt::format(" start=\"{}\"", number(row.start)) : "";
}

/// Outputs contain it in their names. The ratio belongs to both shafts, so to none.
std::string_view shaft_of_input(std::string_view input) {
    if (input.starts_with("drive_") || input.ends_with("_driving")) return "shaft_1";
    return input == "ratio" ? "" : "shaft_2";
}

/// Name of a variable within the terminal; empty if it belongs elsewhere.
std::string member_name(const FmuVariable& variable, std::string_view terminal) {
    if (variable.kind == "input") return shaft_of_input(variable.source) == terminal ? variable.name : "";
    const std::string group = std::string(terminal) + ".";
    return variable.kind == "output" && variable.name.starts_with(group) ? variable.name.substr(group.size()) : "";
}

/// A channel named twice is one variable; a key that has a channel's name gets another name.
void add_once(std::vector<FmuVariable>& all, std::vector<FmuVariable> rows) {
    for (FmuVariable& row : rows) {
        const bool taken = std::any_of(all.begin(), all.end(), [&](const FmuVariable& other) { return other.name == row.name; });
        if (taken && row.kind == "output") continue;
        if (taken) row.name += "_parameter";
        all.push_back(row);
    }
}

std::string file_elements(const char* element, const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += fmt::format("      <{} name=\"{}\"/>\n", element, html(name));
    return text;
}

}  // namespace

std::vector<FmuVariable> fmu_variables(Simulation& simulation, const FmuChoice& choice, bool arrays) {
    std::vector<FmuVariable> all{{0, "time", "time", "s", "simulated time", 1, 0.0, "time"}};
    for (auto& rows : {inputs(simulation, choice.inputs), outputs(simulation, choice.outputs, arrays),
                       parameters(simulation.scene(), choice.parameters)})
        add_once(all, rows);
    all.push_back(
        {0, "flag", "unreliable", "1", "whether the energy balance does not close, so that results are wrong", 1, 0.0, "unreliable"});
    for (std::size_t number = 0; number < all.size(); ++number) all[number].reference = static_cast<std::uint32_t>(number);
    return all;
}

std::string variables_text(const std::vector<FmuVariable>& variables) {
    std::string text;
    for (const FmuVariable& row : variables)
        text += fmt::format("{} {} {} {} {}\n", row.reference, row.kind, row.width, row.source, row.element);
    return text;
}

std::string model_description_2(const FmuFacts& facts, const std::vector<FmuVariable>& variables) {
    std::string text = head(facts, "2.0", "guid");
    text += fmt::format(
        "  <CoSimulation modelIdentifier=\"{}\" canHandleVariableCommunicationStepSize=\"true\" canGetAndSetFMUstate=\"true\" "
        "canSerializeFMUstate=\"true\">\n",
        facts.identifier);
    if (!facts.sources.empty()) text += "    <SourceFiles>\n" + file_elements("File", facts.sources) + "    </SourceFiles>\n";
    text += "  </CoSimulation>\n";
    text += middle(facts, variables) + "  <ModelVariables>\n";
    std::string unknowns;
    for (std::size_t index = 0; index < variables.size(); ++index) {
        const FmuVariable& row = variables[index];
        text += fmt::format("    <ScalarVariable {}><{}{}{}/></ScalarVariable>\n", causality(row), row.kind == "flag" ? "Boolean" : "Real",
                            start_attribute(row), type_attributes(row));
        if (is_output(row)) unknowns += fmt::format("      <Unknown index=\"{}\"/>\n", index + 1);
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
        text += fmt::format("    <{0} {1}{2}{3}>{4}</{0}>\n", row.kind == "flag" ? "Boolean" : "Float64", causality(row),
                            start_attribute(row), type_attributes(row), dimension);
        if (!is_output(row)) continue;
        outputs += fmt::format("    <Output valueReference=\"{}\"/>\n", row.reference);
        initial += fmt::format("    <InitialUnknown valueReference=\"{}\"/>\n", row.reference);
    }
    return text + "  </ModelVariables>\n  <ModelStructure>\n" + outputs + initial + "  </ModelStructure>\n</fmiModelDescription>\n";
}

std::string build_description(const FmuFacts& facts) {
    return fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n  <BuildConfiguration "
        "modelIdentifier=\"{}\" "
        "description=\"A shared library, by GCC or Clang: in sources/, c++ @build.txt -o LIBRARY\">\n    <SourceFileSet language=\"C++20\" "
        "compiler=\"gcc\" compilerOptions=\"{}\">\n{}      <IncludeDirectory name=\".\"/>\n    </SourceFileSet>\n  </BuildConfiguration>\n"
        "</fmiBuildDescription>\n",
        facts.identifier, compiler_options, file_elements("SourceFile", facts.sources));
}

std::string terminals_text(const std::vector<FmuVariable>& variables) {
    std::string text;
    for (const auto& [terminal, description] : {std::pair{"shaft_1", "The driving shaft."}, {"shaft_2", "The driven shaft."}}) {
        std::string members;
        for (const FmuVariable& variable : variables) {
            const std::string member = member_name(variable, terminal);
            if (!member.empty())
                members += fmt::format("      <TerminalMemberVariable variableName=\"{}\" memberName=\"{}\" variableKind=\"signal\"/>\n",
                                       html(variable.name), html(member));
        }
        if (!members.empty())
            text += fmt::format("    <Terminal name=\"{}\" matchingRule=\"bus\" description=\"{}\">\n{}    </Terminal>\n", terminal,
                                description, members);
    }
    if (!text.empty()) text = "  <Terminals>\n" + text + "  </Terminals>\n";
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiTerminalsAndIcons fmiVersion=\"3.0\">\n  <GraphicalRepresentation>\n"
           "    <CoordinateSystem x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\" suggestedScalingFactorTo_mm=\"0.1\"/>\n"
           "    <Icon x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\"/>\n  </GraphicalRepresentation>\n" +
           text + "</fmiTerminalsAndIcons>\n";
}

std::string generation_date() {
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    if (epoch == nullptr || *epoch == '\0') return CVTFLOW_COMMIT_DATE;
    std::int64_t seconds = 0;
    const char* end = epoch + std::strlen(epoch);
    constexpr std::int64_t year_9999 = 253402300799;
    if (std::from_chars(epoch, end, seconds).ptr != end || seconds < 0 || seconds > year_9999)
        throw UsageError(fmt::format("SOURCE_DATE_EPOCH: '{}' is no number of seconds since 1970", epoch));
    const std::time_t time = seconds;
    std::tm parts{};
    gmtime_r(&time, &parts);
    char text[32] = {};
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
    return text;
}

}  // namespace cvtflow::tools
