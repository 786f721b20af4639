#include "tasks/batch/sweep/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/hash.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/scene/cross_checks.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

long Sweep::cases() const noexcept {
    long count = 1;
    for (const Axis& axis : axes) count *= static_cast<long>(axis.rows());
    return axes.empty() ? 0 : count;
}

long Sweep::strand() const noexcept { return continuation.empty() ? 1 : static_cast<long>(axes.back().rows()); }

std::size_t Sweep::row(long number, std::size_t axis) const noexcept {
    for (std::size_t later = axes.size(); later-- > axis + 1;) number /= static_cast<long>(axes[later].rows());
    return static_cast<std::size_t>(number % static_cast<long>(axes[axis].rows()));
}

void Sweep::apply_case(long number, Scene& of) const {
    for (std::size_t a = 0; a < axes.size(); ++a) {
        const std::size_t at = row(number, a);
        for (std::size_t k = 0; k < axes[a].keys.size(); ++k) apply(*axes[a].keys[k], axes[a].at(at, k), of);
    }
}

namespace {

/// All values of an axis if they are few, else their number and hash.
std::string axis_line(const Axis& axis) {
    std::vector<std::string> names, values;
    for (const Parameter* key : axis.keys) names.emplace_back(key->key);
    engine::Hash hash;
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
        const std::string value = axis_text(*axis.keys[i % axis.keys.size()], axis.values[i]);
        hash.add(std::string_view(value)).add(std::string_view("\n"));
        if (axis.values.size() <= 24) values.push_back(value);
    }
    const std::string list =
        values.empty() ? fmt::format("{} rows, hash {}", axis.rows(), hash.hex()) : fmt::format("{}", fmt::join(values, ", "));
    return fmt::format("axes.{} = {}\n", fmt::join(names, "+"), list);
}

constexpr const char* start_modes[] = {"scene", "settle", "shared"};

}  // namespace

std::string Sweep::definition() const {
    std::string lines;
    for (const Parameter& parameter : parameter_table()) {
        const bool matters = !may_change(parameter.key) || parameter.key == "run.until" || parameter.key == "run.max_steps";
        if (matters) lines += fmt::format("{} = {}\n", parameter.key, value_text(parameter, scene));
    }
    for (const Axis& axis : axes) lines += axis_line(axis);
    for (const Scalar& scalar : scalars) lines += fmt::format("outputs.scalars.{0} = {0}\n", scalar.text);
    lines += fmt::format("outputs.from = {}\n", number_text(from));
    lines += fmt::format("start.mode = {}\n", start_modes[static_cast<int>(start)]);
    lines += fmt::format("start.continuation = {}\n", continuation);
    if (accuracy.target > 0.0)
        lines += fmt::format("accuracy.target = {}\naccuracy.verify = {}\naccuracy.seed = {}\n", number_text(accuracy.target),
                             accuracy.verify, accuracy.seed);
    return lines;
}

std::string violations(const Scene& scene) {
    std::string text;
    for (const CrossCheck& check : cross_checks()) {
        if (const auto violation = check.violation(scene)) text += (text.empty() ? "" : "; ") + *violation;
    }
    return text;
}

Scene scene_of_case(const Sweep& sweep, long number) {
    Scene scene = sweep.scene;
    sweep.apply_case(number, scene);
    const bool settles = sweep.start != StartMode::scene || !violations(scene).empty() || fitting_start(scene) == nullptr;
    if (settles) scene.state_file.clear();
    return scene;
}

}  // namespace cvtflow::tasks
