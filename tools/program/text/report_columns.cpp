#include "tools/program/text/report_columns.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/provenance.hpp"
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
    const engine::Provenance here = engine::current_provenance();
    return {{"version", here.version},
            {"commit", here.commit},
            {"compiler", here.compiler},
            {"build_type", here.build_type},
            {"instruction_set", here.instruction_set},
            {"cpu", here.cpu},
            {"cores", here.cores},
            {"os", here.os},
            {"date", here.date}};
}

std::string json_text(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace cvtflow::tools
