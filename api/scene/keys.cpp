/// Keys of scenes and quantities with units, for hosts.

#include <cvtflow/error.hpp>
#include <cvtflow/scene.hpp>

#include <variant>

#include "api/host/translate.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow {
inline namespace v0 {

std::vector<KeyInfo> scene_keys() {
    return api::entered(ErrorCode::internal, [] {
        const tasks::Scene defaults;
        std::vector<KeyInfo> keys;
        for (const tasks::Parameter& row : tasks::parameter_table()) {
            keys.push_back({std::string(row.key),
                            std::string(row.unit),
                            std::string(row.meaning),
                            tasks::value_text(row, defaults),
                            std::string(row.source),
                            row.min,
                            row.max,
                            {row.choices.begin(), row.choices.end()},
                            row.kind() == tasks::Kind::time_table});
        }
        return keys;
    });
}

double quantity(const std::string& text, const std::string& unit) {
    return api::entered(ErrorCode::argument, [&] {
        const auto parsed = tasks::parse_quantity(text);
        if (const auto* wrong = std::get_if<std::string>(&parsed)) throw Error(ErrorCode::argument, "\"" + text + "\" " + *wrong);
        const auto& read = std::get<tasks::Quantity>(parsed);
        const tasks::Dimension expected = tasks::dimension_of(unit);
        const std::string expectation =
            ", expected " + std::string(tasks::dimension_name(expected)) + (unit == "1" ? "" : " (" + unit + ")");
        if (!read.has_unit && unit != "1") throw Error(ErrorCode::argument, "\"" + text + "\" has no unit" + expectation);
        if (read.dimension == expected) return read.value;
        const std::string name(tasks::dimension_name(read.dimension));
        throw Error(ErrorCode::argument, "\"" + text + "\" " + (name.empty() ? "has another dimension" : "is " + name) + expectation);
    });
}

}  // namespace v0
}  // namespace cvtflow
