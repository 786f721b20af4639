#include "tasks/tuning/operating_point.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "tasks/run/saved_start.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double neighbourhood = 0.05;  ///< relative change of constant inputs for unseen points

/// A key whose value is a table over time, and the ends of what it takes.
struct Input {
    const Parameter* key;
    double low, high, at_start;

    [[nodiscard]] bool varies() const noexcept { return low < high; }
};

model::TimeTable& table_of(const Parameter& key, Scene& scene) { return *std::get<model::TimeTable*>(key.member(scene)); }

std::vector<Input> inputs_of(const Scene& scene) {
    Scene copy = scene;
    std::vector<Input> inputs;
    for (const Parameter& key : parameter_table()) {
        if (key.kind() != Kind::time_table) continue;
        const model::TimeTable& table = table_of(key, copy);
        const auto [low, high] = std::minmax_element(table.value.begin(), table.value.end());
        inputs.push_back({&key, *low, *high, table.at(0.0)});
    }
    return inputs;
}

/// All inputs held at what they are at t = 0, for as long as a point takes. Starts as a run does: without a state that fits, every choice
/// settles by itself.
OperatingPoint at_start(const Scene& scene, const PointTimes& times, const std::string& name) {
    OperatingPoint point{name, scene, times.settle, times.settle + times.average};
    point.settles = scene.parameters.start.layout == model::StartLayout::belt && fitting_start(scene) == nullptr;
    if (point.settles) point.scene.state_file.clear();
    for (const Input& input : inputs_of(scene)) {
        if (input.varies()) table_of(*input.key, point.scene) = model::TimeTable(input.at_start);
    }
    point.scene.run.until = point.until;
    return point;
}

std::string named(const Input& input, double value) { return fmt::format("{} = {:.4g} {}", input.key->key, value, input.key->unit); }

/// A ring has no inputs, but a speed. share of the neighbourhood [1]
void vary_ring(OperatingPoint& point, double share) {
    double& speed = point.scene.parameters.start.ring_speed;
    speed *= 1.0 + neighbourhood * (2.0 * share - 1.0);
    point.name = fmt::format("start.ring_speed = {:.4g} rad/s", speed);
}

}  // namespace

std::vector<OperatingPoint> points_of(const Scene& scene, const PointTimes& times) {
    const OperatingPoint start = at_start(scene, times, "start");
    std::vector<OperatingPoint> points{start};
    for (const Input& input : inputs_of(scene)) {
        for (const double value : {input.low, input.high}) {
            if (!input.varies() || value == input.at_start) continue;
            points.push_back(start);
            points.back().name = named(input, value);
            table_of(*input.key, points.back().scene) = model::TimeTable(value);
        }
    }
    return points;
}

std::vector<OperatingPoint> unseen_points(const Scene& scene, const PointTimes& times, int count, std::uint64_t seed) {
    const std::vector<Input> inputs = inputs_of(scene);
    const std::vector<double> where = random_samples(static_cast<std::size_t>(count), inputs.size(), seed);
    std::vector<OperatingPoint> points;
    for (std::size_t n = 0; n < static_cast<std::size_t>(count); ++n) {
        points.push_back(at_start(scene, times, ""));
        if (scene.parameters.detail.pulleys == model::PulleyDetail::absent) {
            vary_ring(points.back(), where[n * inputs.size()]);
            continue;
        }
        for (std::size_t i = 0; i < inputs.size(); ++i) {
            const Input& input = inputs[i];
            const bool near = input.key->section() == "load" || input.key->section() == "clamping";
            if (!input.varies() && (!near || input.at_start == 0.0)) continue;
            const double low = input.varies() ? input.low : input.at_start * (1.0 - neighbourhood);
            const double high = input.varies() ? input.high : input.at_start * (1.0 + neighbourhood);
            const double value = low + where[n * inputs.size() + i] * (high - low);
            table_of(*input.key, points.back().scene) = model::TimeTable(value);
            points.back().name += (points.back().name.empty() ? "" : ", ") + named(input, value);
        }
    }
    return points;
}

OperatingPoint point_of_case(const Sweep& sweep, long number) {
    OperatingPoint point{fmt::format("case {}", number), scene_of_case(sweep, number), sweep.from, 0.0};
    point.until = point.scene.run.until;
    point.settles = point.scene.state_file.empty();
    return point;
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

bool agrees(const Sweep& sweep, long number) {
    Scene scene = sweep.scene;
    sweep.apply_case(number, scene);
    return violations(scene).empty();
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
    std::erase_if(corners, [&](long number) { return !agrees(sweep, number); });
    if (corners.size() <= most) return corners;
    std::vector<long> picked;
    for (std::size_t i = 0; i < most; ++i) picked.push_back(corners[i * (corners.size() - 1) / (most - 1)]);
    return picked;
}

}  // namespace cvtflow::tasks
