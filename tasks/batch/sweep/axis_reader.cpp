#include "tasks/batch/sweep/axis_reader.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/text.hpp"
#include "model/basis/portable_math.hpp"
#include "tasks/batch/results/table_view.hpp"
#include "tasks/batch/sweep/sweep_keys.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::int64_t max_rows = 1'000'000;

/// One table of [[axes]].
class AxisReader {
public:
    AxisReader(Position position, const std::filesystem::path& folder, std::vector<Problem>& problems)
        : position_(position), folder_(folder), problems_(problems) {}

    Axis read(const Node::Table& table) {
        const std::size_t before = problems_.size();
        const TableView view("axes", table, position_, names_in_sweep("axes"), problems_);
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
        const Node::Array* parts = view.list("columns");
        for (const Node& part : parts != nullptr ? *parts : Node::Array{}) {
            const auto* table = std::get_if<Node::Table>(&part.value);
            if (table == nullptr) return view.problem(part.position, "columns: not a table {column = …, key = …}"), columns;
            const TableView own("axes.columns", *table, part.position, names_in_sweep("axes.columns"), problems_);
            const auto name = own.require("column") ? own.text("column") : std::nullopt;
            const Parameter* parameter = key_of(own);
            if (name && parameter != nullptr) columns.push_back({parameter, *name});
        }
        return columns;
    }

    const Parameter* key_of(const TableView& view) {
        if (!view.require("key")) return nullptr;
        const auto name = view.text("key");
        const Parameter* parameter = name ? find_parameter(*name) : nullptr;
        if (name && parameter == nullptr)
            view.problem(view.find("key")->position,
                         fmt::format("key: unknown key {}{}", toml_text(*name), engine::did_you_mean(nearest_keys(*name))));
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
        if (values == nullptr) return axis;
        for (const Node& value : *values) append(axis_value(parameter, value, problems_), axis);
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
        result.logarithmic = view.choice("scale", sweep_choices("axes", "scale")).value_or(0) == 1;
        for (const auto& [name, end] : {std::pair{"from", &result.from}, std::pair{"to", &result.to}}) {
            if (!view.require(name)) continue;
            const auto value = axis_value(parameter, *view.find(name), problems_);
            if (value.empty()) continue;
            if (const auto* number = std::get_if<double>(&value.front()))
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
        if (count && problems_.empty())
            axis.values = numbers(spaced(ends.from, ends.to, static_cast<std::size_t>(*count), ends.logarithmic));
        return axis;
    }

    static std::vector<AxisValue> numbers(const std::vector<double>& values) { return {values.begin(), values.end()}; }

    Axis zip(const TableView& view) {
        Axis axis{"zip", {}, {}};
        const Node::Array* parts = view.list("zip");
        std::vector<Axis> columns;
        for (const Node& part : parts != nullptr ? *parts : Node::Array{}) {
            const auto* table = std::get_if<Node::Table>(&part.value);
            if (table == nullptr) return view.problem(part.position, "zip: not a table {key = …, values = …}"), axis;
            const TableView column("axes.zip", *table, part.position, names_in_sweep("axes.zip"), problems_);
            columns.push_back(one_key(column));
            if (columns.back().rows() != columns.front().rows()) {
                view.problem(part.position, fmt::format("zip: {} values beside {} of {}", columns.back().rows(), columns.front().rows(),
                                                        columns.front().keys.front()->key));
            }
        }
        if (!problems_.empty()) return axis;
        for (const Axis& column : columns) axis.keys.push_back(column.keys.front());
        for (std::size_t row = 0; row < columns.front().rows(); ++row) {
            for (const Axis& column : columns) axis.values.push_back(column.at(row, 0));
        }
        return axis;
    }

    Axis sample(const TableView& view) {
        const int kind = view.choice("sample", sweep_choices("axes", "sample")).value_or(0);
        Axis axis{kind == 1 ? "latin-hypercube" : "random", {}, {}};
        const auto count = view.require("count") ? view.integer("count", 1, max_rows) : std::nullopt;
        const auto seed = view.require("seed") ? view.integer("seed", 0, std::int64_t{1} << 53) : std::nullopt;
        const std::vector<Interval> box = view.require("keys") ? intervals(view) : std::vector<Interval>{};
        if (!count || !seed || !problems_.empty()) return axis;
        const auto size = static_cast<std::size_t>(*count);
        const auto where = (kind == 1 ? latin_hypercube : random_samples)(size, box.size(), static_cast<std::uint64_t>(*seed));
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
        const Node::Array* parts = view.list("keys");
        for (const Node& part : parts != nullptr ? *parts : Node::Array{}) {
            const auto* table = std::get_if<Node::Table>(&part.value);
            if (table == nullptr) return view.problem(part.position, "keys: not a table {key = …, from = …, to = …}"), box;
            const TableView column("axes.keys", *table, part.position, names_in_sweep("axes.keys"), problems_);
            if (const Parameter* parameter = key_of(column)) box.push_back(interval(column, *parameter));
        }
        return box;
    }

    static void append(std::vector<AxisValue> value, Axis& axis) {
        for (AxisValue& each : value) axis.values.push_back(std::move(each));
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

}  // namespace cvtflow::tasks
