#include "tasks/scene/parameter_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "engine/base/text.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {
namespace {

/// Allowed values of a number.
struct Rule {
    std::string_view unit;
    double min, max;
    double usual;  ///< guesses at a forgotten unit go for the value nearest to this one
};

/// " m", or nothing for a plain number.
std::string suffix(std::string_view unit) { return unit == "1" ? std::string{} : fmt::format(" {}", unit); }

struct Written {
    std::string operator()(const auto& /*table*/) const { return "a table"; }
    std::string operator()(const Date&) const { return "a date or time"; }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return std::to_string(value); }
    std::string operator()(double value) const { return std::isfinite(value) ? number_text(value) : fmt::format("{}", value); }
    std::string operator()(const std::string& value) const { return toml_text(value); }
    std::string operator()(const Node::Array&) const { return "a list"; }
};
std::string written(const Node& node) { return std::visit(Written(), node.value); }

/// A number that shows that it is not an integer: 84.0.
std::string real_text(double number) {
    std::string text = number_text(number);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

constexpr double usual_step = 1e-6;  ///< usual size of an automatic number, which is a step [s]

/// The default of a number, list or table (its first value); 0 for other kinds.
double default_number(const Parameter& parameter) {
    Scene scene;
    const Slot slot = parameter.member(scene);
    if (const auto* number = std::get_if<double*>(&slot)) return **number;
    if (const auto* list = std::get_if<std::vector<double>*>(&slot)) return (*list)->front();
    if (const auto* table = std::get_if<model::TimeTable*>(&slot)) return (*table)->value.front();
    if (const auto* table = std::get_if<model::SpeedTable*>(&slot)) return (*table)->value.front();
    if (const auto* number = std::get_if<AutoNumber*>(&slot)) return (*number)->value_or(usual_step);
    return 0.0;
}

/// Distance of two sizes in powers of e.
double log_distance(double value, double usual) { return usual == 0.0 || value == 0.0 ? 0.0 : std::abs(std::log(std::abs(value / usual))); }

class Reader {
public:
    Reader(const Parameter& parameter, std::vector<Problem>& problems) : parameter_(parameter), problems_(problems) {}

    void read(const Node& node, double& member) {
        if (const auto value = number(node, rule())) member = *value;
    }

    void read(const Node& node, AutoNumber& member) {
        const auto* text = std::get_if<std::string>(&node.value);
        const std::string word(parameter_.choices.front());
        if (text && *text == word)
            member = AutoNumber();
        else if (text && !engine::closest(*text, {word}).empty())
            refuse(node, "\"{0}\" is neither a quantity nor \"{1}\" (did you mean \"{1}\"?)", *text, word);
        else if (const auto value = number(node, rule()))
            member = *value;
    }

    template <class Integer>
    requires(std::is_integral_v<Integer> && !std::is_same_v<Integer, bool>) void read(const Node& node, Integer& member) {
        const auto* value = std::get_if<std::int64_t>(&node.value);
        const bool real = std::holds_alternative<double>(node.value);
        if (!value) return refuse(node, "{} is not an integer", real ? real_text(std::get<double>(node.value)) : written(node));
        const auto min = static_cast<std::int64_t>(parameter_.min);
        const auto max = static_cast<std::int64_t>(parameter_.max);
        if (*value < min || *value > max) return refuse(node, "{} is outside [{}, {}]", *value, min, max);
        member = static_cast<Integer>(*value);
    }

    void read(const Node& node, bool& member) {
        const auto* value = std::get_if<bool>(&node.value);
        if (!value) return refuse(node, "{} is neither true nor false", written(node));
        member = *value;
    }

    void read(const Node& node, std::string& member) {
        const auto* value = std::get_if<std::string>(&node.value);
        if (!value) return refuse(node, "{} is not a text", written(node));
        member = *value;
    }

    void read(const Node& node, std::vector<std::string>& member) {
        const auto* list = std::get_if<Node::Array>(&node.value);
        if (list && list->size() > max_points) return refuse(node, "{} texts are more than {}", list->size(), max_points);
        std::vector<std::string> values(list ? list->size() : 1);
        const std::size_t before = problems_.size();
        for (std::size_t i = 0; i < values.size(); ++i) read(list ? (*list)[i] : node, values[i]);
        if (problems_.size() == before) member = std::move(values);
    }

    template <class Choice>
    requires std::is_enum_v<Choice>
    void read(const Node& node, Choice& member) {
        const auto* value = std::get_if<std::string>(&node.value);
        const auto& choices = parameter_.choices;
        const auto chosen = value ? std::find(choices.begin(), choices.end(), *value) : choices.end();
        if (chosen == choices.end()) {
            const std::string hint = value ? choice_hint(*value, {choices.begin(), choices.end()}) : std::string{};
            return refuse(node, "{} is not one of {}{}", written(node), fmt::join(choices, ", "), hint);
        }
        member = static_cast<Choice>(chosen - choices.begin());
    }

    void read(const Node& node, std::vector<double>& member) {
        const auto* list = std::get_if<Node::Array>(&node.value);
        std::vector<double> values;
        if (list && !has_points(node, *list)) return;
        const std::size_t requested = list ? list->size() : 1;
        for (std::size_t i = 0; i < requested; ++i)
            if (const auto value = number(list ? (*list)[i] : node, rule())) values.push_back(*value);
        if (values.size() == requested) member = std::move(values);
    }

    void read(const Node& node, model::TimeTable& member) {
        if (auto points = read_points(node, max_points, {"s", 0.0, latest_time, 0.0}))
            member = model::TimeTable(std::move(points->first), std::move(points->second));
    }

    void read(const Node& node, model::SpeedTable& member) {
        if (auto points = read_points(node, max_speed_points, {"m/s", 0.0, highest_speed, 0.1}))
            member = {std::move(points->first), std::move(points->second)};
    }

private:
    [[nodiscard]] Rule rule() const { return {parameter_.unit, parameter_.min, parameter_.max, default_number(parameter_)}; }

    template <class... Args>
    void refuse(const Node& node, fmt::format_string<Args...> text, Args&&... args) {
        problems_.push_back({node.position, fmt::format("{}: {}", parameter_.key, fmt::format(text, std::forward<Args>(args)...))});
    }

    bool has_points(const Node& node, const Node::Array& list, std::size_t most = max_points) {
        if (list.empty()) refuse(node, "the list is empty");
        if (list.size() > most) refuse(node, "{} points are more than {}", list.size(), most);
        return !list.empty() && list.size() <= most;
    }

    using Points = std::pair<std::vector<double>, std::vector<double>>;

    /// A number, which is one point at 0, or points [place, value] in ascending order. @param place what the first number of a point must
    /// be
    std::optional<Points> read_points(const Node& node, std::size_t most, const Rule& place) {
        const auto* list = std::get_if<Node::Array>(&node.value);
        if (!list) {
            const auto value = number(node, rule());
            return value ? std::optional<Points>({{0.0}, {*value}}) : std::nullopt;
        }
        if (!has_points(node, *list, most)) return std::nullopt;
        Points points;
        for (const Node& point : *list) read_point(point, place, points);
        return points.first.size() == list->size() ? std::optional<Points>(std::move(points)) : std::nullopt;
    }

    /// Appends [place, value] to `points` if it is valid and beyond the last one.
    void read_point(const Node& point, const Rule& place, Points& points) {
        const bool timed = place.unit == "s";
        const auto* pair = std::get_if<Node::Array>(&point.value);
        if (!pair || pair->size() != 2)
            return refuse(point, "{} is not a pair [{}, value]", pair ? "this list" : written(point), timed ? "time" : "speed");
        const auto at = number((*pair)[0], place);
        const auto value = number((*pair)[1], rule());
        if (!at || !value) return;
        if (!points.first.empty() && *at <= points.first.back())
            return refuse((*pair)[0], "{} {} {} is not {} than {} {}", timed ? "time" : "speed", number_text(*at), place.unit,
                          timed ? "later" : "higher", number_text(points.first.back()), place.unit);
        points.first.push_back(*at);
        points.second.push_back(*value);
    }

    /// The number of `node` in SI, checked against `rule`.
    std::optional<double> number(const Node& node, const Rule& rule) {
        if (const auto* text = std::get_if<std::string>(&node.value)) return quantity(node, *text, rule);
        const auto* integer = std::get_if<std::int64_t>(&node.value);
        const auto* real = std::get_if<double>(&node.value);
        if (!integer && !real) return refuse(node, "{} is not a number", written(node)), std::nullopt;
        const double value = real ? *real : static_cast<double>(*integer);
        if (!std::isfinite(value)) return refuse(node, "{} is not a finite number", written(node)), std::nullopt;
        return in_range(node, value, value, written(node) + suffix(rule.unit), rule);
    }

    std::optional<double> quantity(const Node& node, const std::string& text, const Rule& rule) {
        const auto parsed = parse_quantity(text);
        if (const auto* wrong = std::get_if<std::string>(&parsed)) return refuse(node, "\"{}\" {}", text, *wrong), std::nullopt;
        const auto& quantity = std::get<Quantity>(parsed);
        const Dimension expected = dimension_of(rule.unit);
        const auto unit = rule.unit == "1" ? "" : fmt::format(" ({})", rule.unit);
        const auto expectation = fmt::format("expected {}{}", dimension_name(expected), unit);
        if (!quantity.has_unit && rule.unit != "1") return refuse(node, "\"{}\" has no unit, {}", text, expectation), std::nullopt;
        if (!(quantity.dimension == expected)) {
            const auto name = dimension_name(quantity.dimension);
            const auto found = name.empty() ? std::string("has another dimension") : fmt::format("is {}", name);
            const std::string likely = engine::did_you_mean(likely_quantities(text, rule.unit));
            return refuse(node, "{} {}, {}{}", text, found, expectation, likely), std::nullopt;
        }
        return in_range(node, quantity.value, quantity.number, text, rule);
    }

    std::optional<double> in_range(const Node& node, double value, double as_written, const std::string& text, const Rule& rule) {
        if (value >= rule.min && value <= rule.max) return value;
        refuse(node, "{} is outside [{}, {}]{}{}", text, number_text(rule.min), number_text(rule.max), suffix(rule.unit),
               engine::did_you_mean(likely_unit(as_written, text, rule)));
        return std::nullopt;
    }

    /// A number in another usual unit, if that would be in range: "8.12 mm" for 8.12 m.
    static std::string likely_unit(double as_written, const std::string& text, const Rule& rule) {
        std::string likely;
        double least = 0.0;
        for (const auto unit : usual_units(rule.unit)) {
            auto candidate = fmt::format("{} {}", number_text(as_written), unit);
            const auto parsed = parse_quantity(candidate);
            const auto* quantity = std::get_if<Quantity>(&parsed);
            if (!quantity || candidate == text || quantity->value < rule.min || quantity->value > rule.max) continue;
            const double remote = log_distance(quantity->value, rule.usual);
            if (!likely.empty() && remote >= least) continue;
            likely = std::move(candidate);
            least = remote;
        }
        return likely;
    }

    const Parameter& parameter_;
    std::vector<Problem>& problems_;
};

}  // namespace

void read_value(const Parameter& parameter, const Node& node, Scene& scene, std::vector<Problem>& problems) {
    std::visit([&](auto* member) { Reader(parameter, problems).read(node, *member); }, parameter.member(scene));
    const DetailLevel level = std::exchange(scene.level, DetailLevel::given);
    if (level != DetailLevel::given) apply_detail(scene, find_parameter(level_key)->choices[static_cast<std::size_t>(level)]);
}

}  // namespace cvtflow::tasks
