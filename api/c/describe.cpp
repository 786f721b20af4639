/// What the library knows, as JSON: for hosts and for the Python package, which have no lists of their own.

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "api/c/boundary.hpp"
#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/exit_status.hpp"
#include "tasks/run/note_kinds.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/ready_scenes.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::api {

namespace {

using Json = nlohmann::ordered_json;

[[nodiscard]] Json codes() {
    Json rows = Json::array();
    for (int code = 1; code <= last_code; ++code) {
        const std::string name = code_name(static_cast<ErrorCode>(code));
        if (name != "unknown") rows.push_back({{"code", code}, {"name", name}, {"fault", code >= CVTFLOW_NON_FINITE}});
    }
    return rows;
}

[[nodiscard]] Json exit_statuses() {
    Json rows = Json::array();
    for (const auto& [status, meaning] : tasks::exit_statuses) rows.push_back({{"status", static_cast<int>(status)}, {"text", meaning}});
    return rows;
}

/// Names of tasks::Kind, in the order of the enumerators.
constexpr std::string_view kind_names[] = {"number", "automatic",   "integer",    "choice",      "truth",
                                           "text",   "number_list", "time_table", "speed_table", "text_list"};

/// Version and commit of the library.
[[nodiscard]] Json build() {
    const engine::Provenance here = engine::current_provenance();
    return {{"version", cvtflow_version()}, {"commit", here.commit}, {"date", here.commit_date}};
}

/// A value as TOML is JSON as well.
[[nodiscard]] Json keys() {
    const tasks::Scene defaults;
    Json rows = Json::array();
    for (const tasks::Parameter& row : tasks::parameter_table()) {
        const bool number = !row.unit.empty();
        rows.push_back({{"name", row.key},
                        {"kind", kind_names[static_cast<int>(row.kind())]},
                        {"unit", row.unit},
                        {"range", number ? Json{row.min, row.max} : Json()},
                        {"default", Json::parse(tasks::value_text(row, defaults))},
                        {"shown", tasks::readable_value(row, defaults)},
                        {"source", row.source},
                        {"choices", row.choices},
                        {"table", row.kind() == tasks::Kind::time_table},
                        {"text", row.meaning}});
    }
    return rows;
}

[[nodiscard]] Json channels() {
    Json rows = Json::array();
    for (const tasks::Channel& row : tasks::channels()) {
        Json sums;
        if (const auto* of = tasks::quotient_channels_of(row.name)) sums = of->sums;
        rows.push_back({{"name", row.name},
                        {"unit", row.unit},
                        {"per", row.axis},
                        {"on_demand", row.is(tasks::Channel::on_demand)},
                        {"sums", std::move(sums)},
                        {"text", row.description}});
    }
    return rows;
}

[[nodiscard]] Json inputs() {
    Json rows = Json::array();
    for (int number = 0; number <= CVTFLOW_PRESSURE_DRIVEN; ++number) {
        const InputText row = input_text(number);
        rows.push_back({{"name", row.name}, {"unit", row.unit}, {"text", row.description}});
    }
    return rows;
}

[[nodiscard]] Json notes() {
    Json rows = Json::array();
    for (const tasks::NoteKind& row : tasks::note_kinds) rows.push_back({{"name", row.name}, {"text", row.meaning}});
    return rows;
}

/// A unit's exponents of kg, m, s and rad; null for one with halves.
[[nodiscard]] Json exponents_of(std::string_view unit) {
    const std::string_view same = unit == "J" ? "N*m" : unit == "W" ? "N*m/s" : unit;  // units of channels that scenes do not have
    const tasks::Dimension d = tasks::dimension_of(same);
    if ((d.mass | d.length | d.time | d.angle) % 2 != 0) return {};
    return {{"kg", d.mass / 2}, {"m", d.length / 2}, {"s", d.time / 2}, {"rad", d.angle / 2}};
}

/// "quantities": name of the quantity by unit. "exponents", "usual": by SI unit. "shown": the unit in which people read a quantity, the
/// first row that applies.
[[nodiscard]] Json units() {
    std::set<std::string_view> si;
    for (const tasks::Channel& row : tasks::channels()) si.insert(row.unit);
    for (const tasks::Parameter& row : tasks::parameter_table()) si.insert(row.unit);
    Json quantities = Json::object(), usual = Json::object(), exponents = Json::object(), shown = Json::array();
    for (const std::string_view unit : si) {
        if (unit.empty()) continue;
        quantities[std::string(unit)] = tasks::dimension_name(tasks::dimension_of(unit));
        usual[std::string(unit)] = tasks::usual_units(unit);
        exponents[std::string(unit)] = exponents_of(unit);
    }
    for (const tasks::DisplayRow& row : tasks::display_rows()) {
        if (row.si != "1") quantities[std::string(row.shown)] = tasks::dimension_name(tasks::dimension_of(row.si));
        shown.push_back({{"unit", row.si}, {"part", row.part}, {"shown", row.shown}, {"factor", row.factor}});
    }
    return {{"quantities", std::move(quantities)},
            {"usual", std::move(usual)},
            {"exponents", std::move(exponents)},
            {"shown", std::move(shown)}};
}

/// "text" is null for a scene that cannot be read.
[[nodiscard]] Json scenes() {
    Json rows = Json::array();
    for (const tasks::ReadyScene& ready : tasks::ready_scenes()) {
        Json row{{"name", ready.name}, {"path", ready.path.string()}, {"pins", nullptr}, {"text", nullptr}};
        try {
            const tasks::Scene scene = tasks::read_scene(ready.path, tasks::StartState::ignored);
            row["pins"] = scene.parameters.chain.pins;
            row["text"] = scene.description;
        } catch (const tasks::SceneError&) {  // null
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

[[nodiscard]] Json levels() {
    Json rows = Json::array();
    for (const tasks::DetailPreset& row : tasks::detail_presets()) {
        rows.push_back({{"name", row.name},
                        {"cost", row.cost},
                        {"tension_error", row.tension_error},
                        {"slip_error", row.slip_error},
                        {"text", row.meaning}});
    }
    return {{"keys", tasks::dial_keys()}, {"rows", std::move(rows)}};
}

[[nodiscard]] Json methods() {
    Json rows = Json::array();
    for (const engine::StagePlan& row : engine::methods())
        rows.push_back({{"name", row.name}, {"order", row.order}, {"text", row.description}});
    for (const tasks::MethodProgram& row : tasks::method_programs())
        rows.push_back({{"name", row.name}, {"order", row.order}, {"text", row.description}});
    return rows;
}

constexpr std::pair<std::string_view, Json (*)()> subjects[] = {
    {"build", build},   {"codes", codes},       {"exit_statuses", exit_statuses},
    {"keys", keys},     {"channels", channels}, {"inputs", inputs},
    {"notes", notes},   {"units", units},       {"scenes", scenes},
    {"levels", levels}, {"methods", methods},
};

}  // namespace

std::string description(std::string_view what) {
    Json whole = Json::object();
    for (const auto& [name, rows] : subjects) {
        if (what == name) return rows().dump();
        if (what.empty()) whole[std::string(name)] = rows();
    }
    if (what.empty()) return whole.dump();
    std::vector<std::string> names;
    for (const auto& subject : subjects) names.emplace_back(subject.first);
    throw Error(ErrorCode::argument, "what: there is no '" + std::string(what) + "'" + engine::did_you_mean(engine::closest(what, names)));
}

}  // namespace cvtflow::api
