#include "tools/program/text/report_columns.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/record/run/schema.hpp"
#include "tasks/scene/csv.hpp"

namespace cvtflow::tools {

std::string csv_cell(const nlohmann::ordered_json& value, int digits, bool quoted) {
    if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
    if (value.is_null()) return "";
    if (value.is_string()) return tasks::csv_cell(value.get<std::string>(), true, quoted);
    if (!value.is_number_float()) return value.dump();
    const double number = value.get<double>();
    if (!std::isfinite(number)) return "";
    return digits == all_digits ? fmt::format("{}", number) : fmt::format("{:.{}g}", number, digits);
}

nlohmann::ordered_json provenance_json() {
    nlohmann::ordered_json json;
    for (const engine::Attribute& each : engine::attributes_of(engine::current_provenance()))
        std::visit([&](const auto& value) { json[each.name == "program_version" ? "version" : each.name] = value; }, each.value);
    json.erase("hdf5_version");
    return json;
}

std::string json_text(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace cvtflow::tools
