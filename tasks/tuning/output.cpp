#include "tasks/tuning/output.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "engine/base/text.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {

double relative_difference(double is, double expected, double least) noexcept {
    return std::abs(is - expected) / std::max(std::abs(expected), least);
}

namespace {

using M = FigureMeans;
/// Name, meaning, value, whether it needs pulleys, whether it is usual, smallest scale of an error.
constexpr Figure figure_rows[] = {
    {"slip", "mean slip of both pulleys together; errors are relative to at least 1e-4", [](const M& m) { return m.span.slip; }, true, true,
     min_slip},
    {"efficiency", "1 - losses/input over whole pin periods; its error counts in percentage points",
     [](const M& m) { return m.span.efficiency; }, true, true, 1.0},
    {"losses", "losses/input over whole pin periods", [](const M& m) { return 1.0 - m.span.efficiency; }, true, false},
    {"tight_tension", "mean tension of the tight strand", [](const M& m) { return m.span.tight; }, false, true},
    {"slack_tension", "mean tension of the slack strand", [](const M& m) { return m.span.slack; }, false, false},
    {"tips", "largest axial force of an end of a pin, both halves together, mean over time", [](const M& m) { return m.tip; }, true, true},
    {"ratio", "mean speed ratio", [](const M& m) { return m.span.ratio; }, true, false},
    {"thrust_ratio", "mean ratio of both clamping forces; under control the value that the controller finds",
     [](const M& m) { return m.thrust; }, true, false},
};

}  // namespace

std::span<const Figure> figures() noexcept { return figure_rows; }

double TunedOutput::error(double is, double expected) const noexcept {
    const double error = relative_difference(is, expected, figure != nullptr ? figure->least : std::numeric_limits<double>::min());
    return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

namespace {

TunedOutput of_scalar(const std::string& text) {
    std::vector<Problem> problems;
    const Scalar scalar = parse_scalar(text, {}, problems);
    if (problems.empty()) return {scalar.text, nullptr, scalar};
    std::vector<std::string> names;
    for (const Figure& figure : figures()) names.emplace_back(figure.name);
    throw SceneError(fmt::format("outputs: {} is not one of {}{}, nor a scalar such as \"slip median\"", text, fmt::join(names, ", "),
                                 engine::did_you_mean(engine::closest(text, names))));
}

/// Largest force on an end of a pin, the sum of its two halves: comparable at every level of detail. [N]
double largest_pin_end(const model::ChainLayout& at, const std::vector<double>& tip_axial) {
    double largest = 0.0;
    for (int pin = 0; pin < at.links; ++pin) {
        for (int side = 0; side < 2; ++side) {
            const double rear = tip_axial[static_cast<std::size_t>(model::tips_per_link * pin + side)];
            const double front = tip_axial[static_cast<std::size_t>(model::tips_per_link * at.previous(pin) + 2 + side)];
            largest = std::max(largest, std::abs(rear + front));
        }
    }
    return largest;
}

}  // namespace

std::vector<TunedOutput> tuned_outputs(const std::vector<std::string>& names, bool has_pulleys) {
    std::vector<TunedOutput> outputs;
    for (const std::string& name : names) {
        const Figure* figure = std::ranges::find(figure_rows, name, &Figure::name);
        const bool known = figure != std::end(figure_rows);
        if (known && figure->needs_pulleys && !has_pulleys)
            throw SceneError(fmt::format("outputs: {} requires pulleys, but this scene has none", name));
        outputs.push_back(known ? TunedOutput{name, figure} : of_scalar(name));
    }
    if (!outputs.empty()) return outputs;
    for (const Figure& figure : figures()) {
        if (figure.usual && (has_pulleys || !figure.needs_pulleys)) outputs.push_back({std::string(figure.name), &figure});
    }
    return outputs;
}

std::vector<TunedOutput> tuned_outputs(std::span<const Scalar> scalars) {
    std::vector<TunedOutput> outputs;
    for (const Scalar& scalar : scalars) outputs.push_back({scalar.text, nullptr, scalar});
    return outputs;
}

OutputReader::OutputReader(const model::Variator& variator, std::span<const TunedOutput> outputs, int followed_pin, double from)
    : observer_(variator), outputs_(outputs), followed_pin_(followed_pin), from_(from), reducers_(outputs.size()) {}

void OutputReader::output(double time, const Workspace& workspace, const Counters& counters) {
    if (time < from_ - 1e-12 * std::abs(from_)) return;
    const model::Observation& now = reduce(time, workspace, counters, {.sample = true, .output = true, .last = true});
    tip_ += largest_pin_end(workspace.layout(), now.tip_axial);
    thrust_ += now.clamping[0] / now.clamping[1];
    ++count_;
}

void OutputReader::sample(double time, const Workspace& workspace, const Counters& counters) {
    static_cast<void>(reduce(time, workspace, counters, {.sample = true}));
}

const model::Observation& OutputReader::reduce(double time, const Workspace& workspace, const Counters& counters, const Occasion& when) {
    const model::Observation& now = workspace.observed_by(observer_, time);
    means_.add(now, workspace.energy.sums(now.time), workspace.pin_period());
    const Instant instant{now, workspace, counters, followed_pin_, observer_};
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        if (outputs_[i].figure == nullptr) reducers_[i].read(outputs_[i].scalar, instant, when, numbers_);
    }
    return now;
}

std::vector<double> OutputReader::values() const {
    const double n = count_ > 0 ? static_cast<double>(count_) : std::numeric_limits<double>::quiet_NaN();
    const FigureMeans means{means_.all(), tip_ / n, thrust_ / n};
    std::vector<double> values;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        const TunedOutput& output = outputs_[i];
        values.push_back(output.figure != nullptr ? output.figure->read(means) : reducers_[i].result(output.scalar));
    }
    return values;
}

}  // namespace cvtflow::tasks
