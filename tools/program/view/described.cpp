#include "tools/program/view/described.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "tasks/channel/channels.hpp"
#include "tasks/scene/units.hpp"
#include "tools/program/drawing.hpp"
#include "tools/program/text/scene_text.hpp"

namespace cvtflow::tools {

namespace {

using Json = nlohmann::json;

/// "a force" by "N".
Json dimensions() {
    std::set<std::string_view> units;
    for (const tasks::Channel& channel : tasks::channels()) units.insert(channel.unit);
    for (const tasks::Parameter& key : tasks::parameter_table()) units.insert(key.unit);
    Json names = Json::object();
    for (const std::string_view unit : units)
        if (!unit.empty()) names[std::string(unit)] = tasks::dimension_name(tasks::dimension_of(unit));
    for (const tasks::DisplayRow& row : tasks::display_rows())
        if (row.si != "1") names[std::string(row.shown)] = tasks::dimension_name(tasks::dimension_of(row.si));
    return names;
}

/// Values of keys in SI, and as a person enters them. Channels that a scene lists are no quantity of it.
void add_scene(Json& made, const std::optional<tasks::Scene>& scene) {
    made["scene"] = made["texts"] = Json();
    if (!scene) return;
    for (const tasks::Parameter& key : tasks::parameter_table()) {
        const std::string name(key.key);
        made["scene"][name] = Json::parse(tasks::value_text(key, *scene), nullptr, false);
        made["texts"][name] = tasks::readable_value(key, *scene);
    }
}

}  // namespace

Json known_json() {
    Json display = Json::array(), channels = Json::object(), quotients = Json::object();
    for (const tasks::DisplayRow& row : tasks::display_rows()) display.push_back({row.si, row.part, row.shown, row.factor});
    for (const tasks::Channel& channel : tasks::channels()) channels[std::string(channel.name)] = channel.is(tasks::Channel::on_demand);
    for (const tasks::QuotientChannels& each : tasks::quotient_channels()) quotients[std::string(each.name)] = each.sums;
    return {{"display", display},
            {"dimensions", dimensions()},
            {"channels", channels},
            {"quotients", quotients},
            {"dials", tasks::dial_keys()}};
}

Json described(const RecordedRun& run) {
    Json made{{"file", path_for_python(run.path())}, {"path", run.path()}, {"name", run.name()}};
    add_scene(made, run.scene());
    return made;
}

Json described(const SweepView& sweep) {
    Json columns = Json::array(), limits = Json::array();
    for (std::size_t c = 0; c < sweep.columns.size(); ++c) {
        const SweepColumn& column = sweep.columns[c];
        Json values = Json::array();
        for (std::size_t row = 0; row < sweep.cells.size(); ++row)
            values.push_back(column.number ? Json(sweep.number(row, c)) : Json(sweep.cells[row][c]));
        columns.push_back({{"name", column.name},
                           {"unit", column.unit},
                           {"description", column.description},
                           {"axis", column.axis},
                           {"number", column.number},
                           {"values", std::move(values)}});
    }
    const bool drawn = std::ranges::any_of(sweep.columns, [](const SweepColumn& each) { return each.name == "load_torque"; });
    for (std::size_t row = 0; row < sweep.cells.size(); ++row) limits.push_back(drawn ? load_limit(sweep, row).value_or(NAN) : NAN);
    return {{"path", sweep.path},
            {"name", sweep.name},
            {"level", sweep.scene ? level_text(*sweep.scene) : ""},
            {"columns", std::move(columns)},
            {"limits", std::move(limits)}};
}

Json described(const Measured& measured) {
    Json columns = Json::array();
    for (const MeasuredColumn& column : measured.columns) {
        const std::string_view dimension = column.unit.empty() ? "" : tasks::dimension_name(tasks::dimension_of(column.unit));
        columns.push_back({{"name", column.name}, {"unit", column.unit}, {"dimension", dimension}, {"values", column.values}});
    }
    return {{"path", measured.path}, {"name", measured.name}, {"columns", std::move(columns)}};
}

std::string subject_of(const nlohmann::json& request) {
    return request[request.contains("sweeps") ? "sweeps" : "records"][0]["name"].get<std::string>();
}

}  // namespace cvtflow::tools
