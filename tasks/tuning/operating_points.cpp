#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "engine/base/text.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/tuning/dial.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double min_slip = 1e-4;       ///< creep below a ten-thousandth is treated as zero
constexpr double neighbourhood = 0.05;  ///< relative change of constant inputs for unseen points

/// Outputs by name, and their errors.
constexpr Figure figure_rows[] = {
    {"slip", "slip mean", "mean slip of both pulleys together; errors are relative to at least 1e-4", true,
     [](double slip) { return std::max(std::abs(slip), min_slip); }},
    {"efficiency", "efficiency mean", "1 - losses/input over whole pin periods; its error counts in percentage points", true,
     [](double) { return 1.0; }},
    {"losses", "efficiency mean", "losses/input over whole pin periods", false,
     [](double efficiency) { return std::abs(1.0 - efficiency); }},
    {"tight_tension", "tight_tension mean", "mean tension of the tight strand", true},
    {"slack_tension", "slack_tension mean", "mean tension of the slack strand", false},
    {"tips", "pins/end_force mean", "largest axial force of an end of a pin, both halves together, mean over time", true},
    {"ratio", "ratio mean", "mean speed ratio", false},
    {"thrust_ratio", "thrust_ratio mean", "mean ratio of both clamping forces; under control the value that the controller finds", false},
};

/// Whether a ring of links has a figure.
bool is_of_any_machine(const Figure& figure) { return figure.name.ends_with("_tension"); }

TunedOutput output_of(const std::string& text, const Figure* figure) {
    std::vector<Problem> problems;
    const Scalar scalar = parse_scalar(figure != nullptr ? std::string(figure->scalar) : text, {}, problems);
    if (problems.empty() && figure != nullptr) return {text, scalar, figure->scale};
    if (problems.empty()) return {scalar.text, scalar};
    std::vector<std::string> names;
    for (const Figure& known : figures()) names.emplace_back(known.name);
    throw SceneError(fmt::format("outputs: {} is not one of {}{}, nor a scalar such as \"slip median\"", text, fmt::join(names, ", "),
                                 engine::did_you_mean(engine::closest(text, names))));
}

}  // namespace

std::span<const Figure> figures() noexcept { return figure_rows; }

double TunedOutput::error(double is, double expected) const noexcept {
    const double error = std::abs(is - expected) / std::max(scale != nullptr ? scale(expected) : std::abs(expected), 1e-300);
    return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

std::vector<TunedOutput> tuned_outputs(const std::vector<std::string>& names, bool has_pulleys) {
    std::vector<TunedOutput> outputs;
    for (const std::string& name : names) {
        const Figure* figure = std::ranges::find(figure_rows, name, &Figure::name);
        const bool known = figure != std::end(figure_rows);
        if (known && !is_of_any_machine(*figure) && !has_pulleys)
            throw SceneError(fmt::format("outputs: {} requires pulleys, but this scene has none", name));
        outputs.push_back(output_of(name, known ? figure : nullptr));
    }
    for (const Figure& figure : figures()) {
        if (names.empty() && figure.usual && (has_pulleys || is_of_any_machine(figure)))
            outputs.push_back(output_of(std::string(figure.name), &figure));
    }
    return outputs;
}

namespace {

/// A key whose value is a table over time, and the ends of what it takes.
struct Input {
    const Parameter* key;
    double low, high, at_start;

    [[nodiscard]] bool varies() const noexcept { return low < high; }
};

/// Tables over time but for those of vehicle and cycle, which act by other ones.
std::vector<Input> inputs_of(Scene scene) {
    std::vector<Input> inputs;
    for (const Parameter& key : parameter_table()) {
        if (key.kind() != Kind::time_table || key.section() == "vehicle" || key.section() == "cycle") continue;
        const model::TimeTable& table = *std::get<model::TimeTable*>(key.member(scene));
        const auto [low, high] = std::minmax_element(table.value.begin(), table.value.end());
        inputs.push_back({&key, *low, *high, table.at(0.0)});
    }
    return inputs;
}

/// An operating point begins anew with its inputs held, which a far end that turns on by itself does not allow.
void require_held_inputs(const Scene& scene) {
    const model::Parameters& p = scene.parameters;
    if (scene.vehicle.present())
        throw SceneError(
            fmt::format("{}: a [vehicle] cannot be tuned: the load follows from its speed; tune a scene without it at a speed "
                        "and torque of its own, and use the result here",
                        scene.name));
    if (p.hydraulics.mode != model::HydraulicMode::none)
        throw SceneError(fmt::format(
            "{}: hydraulics.mode \"{}\" cannot be tuned: oil carries on what it held; tune with \"none\", and use the result here",
            scene.name, p.hydraulics.mode == model::HydraulicMode::force ? "force" : "pressure"));
    if (p.drive.mode == model::DriveMode::coupling || p.load.mode != model::LoadMode::torque)
        throw SceneError(
            fmt::format("{}: drive.mode \"coupling\" and load.mode \"speed\" and \"coupling\" cannot be tuned; tune with "
                        "load.mode = \"torque\" and the torque that acts, and use the result here",
                        scene.name));
}

/// Points with some inputs at other values: rows of one axis, whose first is the scene as it is at t = 0. A point starts as a run does:
/// without a state that fits, every choice settles by itself.
class InputPoints {
public:
    InputPoints(const Scene& scene, const PointTimes& times, const std::vector<TunedOutput>& outputs, const std::vector<Input>& inputs)
        : inputs_(inputs) {
        require_held_inputs(scene);
        made_.outputs = outputs;
        made_.sweep.name = scene.name;
        made_.sweep.scene = scene;
        made_.sweep.scene.run.until = times.settle + times.average;
        made_.sweep.from = times.settle;
        for (const TunedOutput& output : outputs) made_.sweep.scalars.push_back(output.scalar);
        for (const Input& input : inputs) axis_.keys.push_back(input.key);
    }
    void add(const std::vector<double>& values, const std::string& name) {
        made_.cases.push_back(static_cast<long>(made_.cases.size()));
        made_.names.push_back(name);
        axis_.values.insert(axis_.values.end(), values.begin(), values.end());
    }
    [[nodiscard]] std::string named(std::size_t input, double value) const {
        return fmt::format("{} = {:.4g} {}", inputs_[input].key->key, value, inputs_[input].key->unit);
    }
    [[nodiscard]] OperatingPoints points() {
        if (!axis_.keys.empty()) made_.sweep.axes.push_back(axis_);
        return made_;
    }

private:
    const std::vector<Input>& inputs_;
    OperatingPoints made_;
    Axis axis_{"zip", {}, {}};
};

}  // namespace

OperatingPoints points_of(const Scene& scene, const PointTimes& times, const std::vector<TunedOutput>& outputs) {
    std::vector<Input> inputs = inputs_of(scene);
    std::erase_if(inputs, [](const Input& input) { return !input.varies(); });
    InputPoints points(scene, times, outputs, inputs);
    std::vector<double> start;
    for (const Input& input : inputs) start.push_back(input.at_start);
    points.add(start, "start");
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        for (const double value : {inputs[i].low, inputs[i].high}) {
            if (value == start[i]) continue;
            std::vector<double> values = start;
            values[i] = value;
            points.add(values, points.named(i, value));
        }
    }
    return points.points();
}

OperatingPoints unseen_points(const Scene& scene, const PointTimes& times, const std::vector<TunedOutput>& outputs, std::size_t count,
                              std::uint64_t seed) {
    std::vector<Input> inputs;
    std::vector<std::size_t> columns;  // each input has a number of its sample, whether it varies or not
    const std::vector<Input> all = inputs_of(scene);
    const auto around = [](double value) { return std::pair(value * (1.0 - neighbourhood), value * (1.0 + neighbourhood)); };
    const bool ring = scene.parameters.detail.pulleys == model::PulleyDetail::absent;  // it has no inputs, but a speed
    for (Input input : all) {
        const bool near = input.key->section() == "load" || input.key->section() == "clamping";
        if (ring || (!input.varies() && (!near || input.at_start == 0.0))) continue;
        columns.push_back(static_cast<std::size_t>(std::ranges::find(all, input.key, &Input::key) - all.begin()));
        if (!input.varies()) std::tie(input.low, input.high) = around(input.at_start);
        inputs.push_back(input);
    }
    if (ring) {
        const double speed = scene.parameters.start.ring_speed;
        inputs.push_back({find_parameter("start.ring_speed"), around(speed).first, around(speed).second, speed});
        columns.push_back(0);
    }
    InputPoints points(scene, times, outputs, inputs);
    const std::vector<double> where = random_samples(count, all.size(), seed);
    for (std::size_t n = 0; n < count; ++n) {
        std::vector<double> values;
        std::vector<std::string> names;
        for (std::size_t i = 0; i < inputs.size(); ++i) {
            values.push_back(inputs[i].low + where[n * all.size() + columns[i]] * (inputs[i].high - inputs[i].low));
            names.push_back(points.named(i, values.back()));
        }
        points.add(values, fmt::format("{}", fmt::join(names, ", ")));
    }
    return points.points();
}

OperatingPoints points_of(const Sweep& sweep, const std::vector<long>& cases) {
    OperatingPoints points{sweep, {}, cases, {}};
    for (const Scalar& scalar : sweep.scalars) points.outputs.push_back({scalar.text, scalar});
    for (const long number : cases) points.names.push_back(fmt::format("case {}", number));
    return points;
}

namespace {

/// Rows of an axis in which one of its keys is lowest or highest; texts have their first and last row.
std::set<std::size_t> extreme_rows(const Axis& axis) {
    std::set<std::size_t> rows{0, axis.rows() - 1};
    for (std::size_t key = 0; key < axis.keys.size(); ++key) {
        std::size_t lowest = 0, highest = 0;
        for (std::size_t row = 0; row < axis.rows(); ++row) {
            const auto* value = std::get_if<double>(&axis.at(row, key));
            const auto *low = std::get_if<double>(&axis.at(lowest, key)), *high = std::get_if<double>(&axis.at(highest, key));
            if (value == nullptr || low == nullptr || high == nullptr) continue;
            if (*value < *low) lowest = row;
            if (*value > *high) highest = row;
        }
        rows.insert({lowest, highest});
    }
    return rows;
}

}  // namespace

std::vector<long> corner_cases(const Sweep& sweep, std::size_t most) {
    std::vector<long> corners{0};
    for (const Axis& axis : sweep.axes) {
        std::vector<long> more;
        for (const long before : corners) {
            for (const std::size_t row : extreme_rows(axis))
                more.push_back(before * static_cast<long>(axis.rows()) + static_cast<long>(row));
        }
        corners = std::move(more);
    }
    std::erase_if(corners, [&](long number) {
        Scene scene = sweep.scene;
        sweep.apply_case(number, scene);
        return !violations(scene).empty();
    });
    if (corners.size() <= most) return corners;
    std::vector<long> picked;
    for (std::size_t i = 0; i < most; ++i) picked.push_back(corners[i * (corners.size() - 1) / (most - 1)]);
    return picked;
}

}  // namespace cvtflow::tasks
