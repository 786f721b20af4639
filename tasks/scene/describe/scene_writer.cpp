#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml/toml_tree.hpp"
#include "tasks/scene/toml/units.hpp"

namespace cvtflow::tasks {
namespace {

std::string list_text(const std::vector<double>& values) {
    if (values.size() == 1) return number_text(values.front());
    std::vector<std::string> texts;
    for (const double value : values) texts.push_back(number_text(value));
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string texts_text(const std::vector<std::string>& values) {
    std::vector<std::string> texts;
    for (const std::string& value : values) texts.push_back(toml_text(value));
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string table_text(const std::vector<double>& place, const std::vector<double>& value) {
    if (place == std::vector{0.0}) return number_text(value.front());
    std::vector<std::string> points;
    for (std::size_t i = 0; i < place.size(); ++i) points.push_back(fmt::format("[{}, {}]", number_text(place[i]), number_text(value[i])));
    return fmt::format("[{}]", fmt::join(points, ", "));
}

}  // namespace

std::string value_text(const Parameter& parameter, const Scene& scene) {
    Scene copy = scene;
    return std::visit(
        [&](const auto* member) -> std::string {
            using T = std::remove_cv_t<std::remove_pointer_t<decltype(member)>>;
            if constexpr (std::is_same_v<T, double>)
                return number_text(*member);
            else if constexpr (std::is_same_v<T, AutoNumber>)
                return member->automatic() ? "\"auto\"" : number_text(*member);
            else if constexpr (std::is_same_v<T, bool>)
                return *member ? "true" : "false";
            else if constexpr (std::is_same_v<T, std::string>)
                return toml_text(*member);
            else if constexpr (std::is_same_v<T, std::vector<double>>)
                return list_text(*member);
            else if constexpr (std::is_same_v<T, std::vector<std::string>>)
                return texts_text(*member);
            else if constexpr (std::is_same_v<T, model::TimeTable>)
                return table_text(member->time, member->value);
            else if constexpr (std::is_same_v<T, model::SpeedTable>)
                return table_text(member->speed, member->value);
            else if constexpr (std::is_enum_v<T>)
                return toml_text(std::string(parameter.choices[static_cast<std::size_t>(*member)]));
            else
                return std::to_string(*member);
        },
        parameter.member(copy));
}

std::string write_scene(const Scene& scene) {
    std::string text;
    std::string_view section;
    for (const Parameter& parameter : parameter_table()) {
        if (parameter.section() != section) text += fmt::format("{}[{}]\n", section.empty() ? "" : "\n", parameter.section());
        section = parameter.section();
        const bool has_unit = !parameter.unit.empty() && parameter.unit != "1";
        const std::string value = value_text(parameter, scene);
        const auto unit = has_unit && !value.starts_with('"') ? fmt::format("  # {}", parameter.unit) : "";
        text += fmt::format("{} = {}{}\n", parameter.name(), value, unit);
    }
    return text;
}

}  // namespace cvtflow::tasks
