#include "tasks/batch/sweep/axis.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <sstream>
#include <type_traits>

#include "engine/base/input_file.hpp"
#include "engine/base/text.hpp"
#include "model/basis/portable_math.hpp"
#include "tasks/batch/sweep/sweep_keys.hpp"
#include "tasks/scene/csv.hpp"

namespace cvtflow::tasks {

namespace {

/// A level of detail is none: its text sets other keys.
template <class T>
concept Number = std::is_arithmetic_v<T> ||(std::is_enum_v<T> && !std::is_same_v<T, DetailLevel>);
template <class T>
concept Integer = Number<T> && std::is_integral_v<T>;

/// The number that a member holds, if it is a single one.
[[nodiscard]] std::optional<double> single(const auto& /*member*/) { return {}; }
[[nodiscard]] std::optional<double> single(const Number auto& number) { return static_cast<double>(number); }
[[nodiscard]] std::optional<double> single(const AutoNumber& number) {
    return number.automatic() ? std::optional<double>() : static_cast<double>(number);
}
[[nodiscard]] std::optional<double> single(const std::vector<double>& list) {
    return list.size() == 1 ? list.front() : std::optional<double>();
}
[[nodiscard]] std::optional<double> single(const model::TimeTable& table) {
    return table.time.size() == 1 ? table.value.front() : std::optional<double>();
}

void set_number(auto& /*member*/, double) {}
void set_number(Number auto& member, double number) { member = static_cast<std::remove_reference_t<decltype(member)>>(number); }
void set_number(Integer auto& member, double number) {
    member = static_cast<std::remove_reference_t<decltype(member)>>(std::llround(number));
}
void set_number(bool& member, double number) { member = number != 0.0; }
void set_number(AutoNumber& member, double number) { member = AutoNumber(number); }
void set_number(std::vector<double>& member, double number) { member.assign(1, number); }
void set_number(model::TimeTable& member, double number) {
    member.time.assign(1, 0.0);
    member.value.assign(1, number);
}

/// The value that `node` gives a key; nothing, with a problem appended, if it is invalid.
std::optional<AxisValue> axis_value(const Parameter& parameter, const Node& node, std::vector<Problem>& problems) {
    Scene scratch;
    const std::size_t before = problems.size();
    read_value(parameter, node, scratch, problems);
    if (problems.size() != before) return {};
    const auto number = std::visit([](const auto* member) { return single(*member); }, parameter.member(scratch));
    return number ? AxisValue(*number) : AxisValue(value_text(parameter, scratch));
}

/// Uniform in [0, 1): 53 bits of the generator, whose sequence the standard fixes (that of its distributions it does not).
[[nodiscard]] double uniform(std::mt19937_64& generator) { return static_cast<double>(generator() >> 11U) * 0x1p-53; }

}  // namespace

void apply(const Parameter& parameter, const AxisValue& value, Scene& scene) {
    if (const auto* number = std::get_if<double>(&value)) {
        std::visit([&](auto* member) { set_number(*member, *number); }, parameter.member(scene));
        return;
    }
    const auto parsed = parse_toml("value = " + std::get<std::string>(value));
    std::vector<Problem> none;  // it was read before
    read_value(parameter, std::get<Node::Table>(std::get<Node>(parsed).value).front().node, scene, none);
}

std::string axis_text(const Parameter& parameter, const AxisValue& value) {
    Scene scratch;
    apply(parameter, value, scratch);
    return value_text(parameter, scratch);
}

bool continuous(const Parameter& parameter) {
    const Kind kind = parameter.kind();
    return kind == Kind::number || kind == Kind::auto_number || kind == Kind::integer || kind == Kind::number_list ||
           kind == Kind::time_table;
}

std::vector<double> spaced(double from, double to, std::size_t count, bool logarithmic) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) {
        const double share = count == 1 ? 0.0 : static_cast<double>(i) / static_cast<double>(count - 1);
        const double between = logarithmic ? from * model::portable_pow(to / from, share) : from + share * (to - from);
        values.push_back(i == 0 ? from : i + 1 == count ? to : between);  // ends exactly
    }
    return values;
}

std::vector<double> random_samples(std::size_t count, std::size_t dimensions, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::vector<double> samples(count * dimensions);
    for (double& sample : samples) sample = uniform(generator);
    return samples;
}

std::vector<double> latin_hypercube(std::size_t count, std::size_t dimensions, std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::vector<double> samples(count * dimensions);
    std::vector<std::size_t> order(count);
    for (std::size_t d = 0; d < dimensions; ++d) {
        for (std::size_t i = 0; i < count; ++i) order[i] = i;
        for (std::size_t i = count; i > 1; --i)
            std::swap(order[i - 1], order[static_cast<std::size_t>(uniform(generator) * static_cast<double>(i))]);
        for (std::size_t i = 0; i < count; ++i) {
            samples[i * dimensions + d] = (static_cast<double>(order[i]) + uniform(generator)) / static_cast<double>(count);
        }
    }
    return samples;
}

namespace {

constexpr std::int64_t max_rows = 1'000'000;

/// One table of [[axes]].
class AxisReader {
public:
    AxisReader(Position position, const std::filesystem::path& folder, std::vector<Problem>& problems)
        : position_(position), folder_(folder), problems_(problems) {}

    Axis read(const Node::Table& table) {
        const std::size_t before = problems_.size();
        const TableView view("axes", table, position_, problems_);
        Axis axis;
        if (view.has("csv"))
            axis = csv(view);
        else if (view.has("zip"))
            axis = zip(view);
        else if (view.has("sample"))
            axis = sample(view);
        else
            axis = one_key(view);
        return problems_.size() == before ? axis : Axis{};
    }

private:
    Axis csv(const TableView& view) {
        const auto name = view.text("csv");
        const std::vector<CsvColumn> columns = view.has("columns") ? csv_columns(view) : std::vector<CsvColumn>{};
        if (!name || !problems_.empty()) return {};
        return read_csv_axis(folder_ / *name, columns, view.find("csv")->position, problems_);
    }

    std::vector<CsvColumn> csv_columns(const TableView& view) {
        std::vector<CsvColumn> columns;
        view.each_table("columns", "column = …, key = …", [&](const TableView& own) {
            const auto name = own.require("column") ? own.text("column") : std::nullopt;
            const Parameter* parameter = key_of(own);
            if (name && parameter != nullptr) columns.push_back({parameter, *name});
        });
        return columns;
    }

    const Parameter* key_of(const TableView& view) {
        if (!view.require("key")) return nullptr;
        const auto name = view.text("key");
        const Parameter* parameter = name ? find_parameter(*name) : nullptr;
        if (name && parameter == nullptr)
            view.problem(view.find("key")->position, fmt::format("key: unknown key {}{}", toml_text(*name), key_hint(*name)));
        return parameter;
    }

    Axis one_key(const TableView& view) {
        const Parameter* parameter = key_of(view);
        if (parameter == nullptr) return {};
        if (view.has("values")) return list(view, *parameter);
        if (view.has("from")) return range(view, *parameter);
        view.problem(position_, "key: values, or from, to and count, are missing");
        return {};
    }

    Axis list(const TableView& view, const Parameter& parameter) {
        Axis axis{"list", {&parameter}, {}};
        const Node::Array* values = view.list("values");
        for (const Node& node : values != nullptr ? *values : Node::Array{})
            if (auto value = axis_value(parameter, node, problems_)) axis.values.push_back(*std::move(value));
        return axis;
    }

    /// Ends of an interval and whether it is logarithmic.
    struct Interval {
        const Parameter* parameter = nullptr;
        double from = 0.0, to = 0.0;
        bool logarithmic = false;
    };

    Interval interval(const TableView& view, const Parameter& parameter) {
        Interval result{&parameter};
        if (!continuous(parameter))
            view.problem(view.position(), fmt::format("from: {} has no values in between; list them", parameter.key));
        result.logarithmic = view.choice("scale").value_or(0) == 1;
        for (const auto& [name, end] : {std::pair{"from", &result.from}, std::pair{"to", &result.to}}) {
            if (!view.require(name)) continue;
            const auto value = axis_value(parameter, *view.find(name), problems_);
            if (!value) continue;
            if (const auto* number = std::get_if<double>(&*value))
                *end = *number;
            else
                view.problem(view.find(name)->position, fmt::format("{}: not a single number", name));
        }
        if (result.logarithmic && !(result.from * result.to > 0.0))
            view.problem(view.find("scale")->position, "scale: a logarithmic range cannot reach or cross zero");
        return result;
    }

    Axis range(const TableView& view, const Parameter& parameter) {
        Axis axis{"range", {&parameter}, {}};
        const Interval ends = interval(view, parameter);
        const auto count = view.require("count") ? view.integer("count", 1, max_rows) : std::nullopt;
        if (!count || !problems_.empty()) return axis;
        for (const double value : spaced(ends.from, ends.to, static_cast<std::size_t>(*count), ends.logarithmic))
            axis.values.emplace_back(value);
        return axis;
    }

    Axis zip(const TableView& view) {
        Axis axis{"zip", {}, {}};
        std::vector<Axis> columns;
        view.each_table("zip", "key = …, values = …", [&](const TableView& column) {
            columns.push_back(one_key(column));
            if (!columns.front().keys.empty() && columns.back().rows() != columns.front().rows()) {
                view.problem(column.position(), fmt::format("zip: {} values beside {} of {}", columns.back().rows(), columns.front().rows(),
                                                            columns.front().keys.front()->key));
            }
        });
        if (!problems_.empty()) return axis;
        for (const Axis& column : columns) axis.keys.push_back(column.keys.front());
        for (std::size_t row = 0; row < columns.front().rows(); ++row) {
            for (const Axis& column : columns) axis.values.push_back(column.at(row, 0));
        }
        return axis;
    }

    Axis sample(const TableView& view) {
        const int kind = view.choice("sample").value_or(0);
        Axis axis{kind == 1 ? "latin-hypercube" : "random", {}, {}};
        const auto count = view.require("count") ? view.integer("count", 1, max_rows) : std::nullopt;
        const auto seed = view.integer("seed", 0, std::int64_t{1} << 53).value_or(0);
        const std::vector<Interval> box = view.require("keys") ? intervals(view) : std::vector<Interval>{};
        if (!count || !problems_.empty()) return axis;
        const auto size = static_cast<std::size_t>(*count);
        const auto where = (kind == 1 ? latin_hypercube : random_samples)(size, box.size(), static_cast<std::uint64_t>(seed));
        for (const Interval& ends : box) axis.keys.push_back(ends.parameter);
        for (std::size_t i = 0; i < where.size(); ++i) {
            const Interval& ends = box[i % box.size()];
            axis.values.emplace_back(ends.logarithmic ? ends.from * model::portable_pow(ends.to / ends.from, where[i])
                                                      : ends.from + where[i] * (ends.to - ends.from));
        }
        return axis;
    }

    std::vector<Interval> intervals(const TableView& view) {
        std::vector<Interval> box;
        view.each_table("keys", "key = …, from = …, to = …", [&](const TableView& column) {
            if (const Parameter* parameter = key_of(column)) box.push_back(interval(column, *parameter));
        });
        return box;
    }

    Position position_;
    const std::filesystem::path& folder_;
    std::vector<Problem>& problems_;
};

}  // namespace

Axis read_axis(const Entry& entry, const Node& node, const std::filesystem::path& folder, std::vector<Problem>& problems) {
    const auto* table = std::get_if<Node::Table>(&node.value);
    if (table == nullptr) {
        problems.push_back({entry.position, "axes: not a table; write [[axes]]"});
        return {};
    }
    std::vector<Problem> own;  // a range of an axis is read even if another axis is wrong
    Axis axis = AxisReader(node.position, folder, own).read(*table);
    problems.insert(problems.end(), own.begin(), own.end());
    return axis;
}

namespace {

class CsvReader {
public:
    CsvReader(std::string name, const std::vector<CsvColumn>& columns, Position position, std::vector<Problem>& problems)
        : name_(std::move(name)), chosen_(columns), position_(position), problems_(problems) {}

    void line(const std::string& text) {
        ++line_;
        if (is_blank(text)) return;
        if (units_.empty()) {
            separator_ = csv_separator(text);
            return heading(cells_of(text, separator_));
        }
        const auto cells = cells_of(text, separator_);
        if (cells.size() != units_.size()) return problem(1, fmt::format("{} cells, not {}", cells.size(), units_.size()));
        for (std::size_t k = 0; k < taken_.size(); ++k) cell(*axis_.keys[k], taken_[k], cells[taken_[k]]);
    }
    [[nodiscard]] bool good() const noexcept { return good_; }
    [[nodiscard]] const Axis& axis() const noexcept { return axis_; }
    void problem(std::size_t column, const std::string& message) {
        good_ = false;
        problems_.push_back({position_, fmt::format("axes.csv: {}:{}:{}: {}", name_, line_, column, message)});
    }

private:
    void heading(const std::vector<std::string>& cells) {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            auto [name, unit] = heading_of(cells[i]);
            units_.push_back(unit);
            if (chosen_.empty()) take(i, name, find_parameter(name));
            names.push_back(std::move(name));
        }
        for (const CsvColumn& column : chosen_) {
            const auto found = std::find(names.begin(), names.end(), column.name);
            if (found == names.end())
                problem(1, fmt::format("unknown column {}{}", toml_text(column.name),
                                       engine::did_you_mean(engine::closest(column.name, names))));
            else
                take(static_cast<std::size_t>(found - names.begin()), column.name, column.key);
        }
    }

    void take(std::size_t column, const std::string& key, const Parameter* parameter) {
        if (parameter == nullptr) return problem(column + 1, fmt::format("unknown key {}{}", toml_text(key), key_hint(key)));
        taken_.push_back(column);
        axis_.keys.push_back(parameter);
    }

    void cell(const Parameter& parameter, std::size_t i, const std::string& text) {
        const auto parsed = parse_toml("value = " + text);
        Node node{text + (units_[i].empty() ? "" : " " + units_[i]), {}};
        if (const auto* document = std::get_if<Node>(&parsed); document != nullptr && units_[i].empty())
            node = std::get<Node::Table>(document->value).front().node;
        std::vector<Problem> own;
        if (auto value = axis_value(parameter, node, own)) axis_.values.push_back(*std::move(value));
        for (const Problem& each : own) problem(i + 1, each.message);
    }

    std::string name_;
    const std::vector<CsvColumn>& chosen_;
    Position position_;
    std::vector<Problem>& problems_;
    Axis axis_{"csv", {}, {}};
    char separator_ = ',';
    std::vector<std::string> units_;  ///< units of all columns
    std::vector<std::size_t> taken_;  ///< column of each key of the axis
    int line_ = 0;
    bool good_ = true;
};

}  // namespace

Axis read_csv_axis(const std::filesystem::path& file, const std::vector<CsvColumn>& columns, Position position,
                   std::vector<Problem>& problems) {
    CsvReader reader(file.filename().string(), columns, position, problems);
    std::error_code unknown;
    if (!std::filesystem::exists(file, unknown)) {
        problems.push_back({position, fmt::format("axes.csv: no file {}", toml_text(file.string()))});
        return {};
    }
    try {
        const std::string content = engine::read_text_input(file.string(), longest_csv);
        if (const auto doubtful = doubtful_number(content)) {
            problems.push_back(
                {position, fmt::format("axes.csv: {}:{}: {}", file.filename().string(), doubtful->position.line, doubtful->message)});
            return {};
        }
        std::istringstream text(content);
        for (std::string line; std::getline(text, line);) reader.line(line);
    } catch (const engine::InputError& error) {
        problems.push_back({position, fmt::format("axes.csv: {} cannot be read: {}", toml_text(file.string()), error.what())});
        return {};
    }
    if (reader.good() && reader.axis().rows() == 0) reader.problem(1, "no rows");
    return reader.good() ? reader.axis() : Axis{};
}

}  // namespace cvtflow::tasks
