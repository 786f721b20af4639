#include "bench/study/spectrum.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "bench/method/analysis/eigenvalues.hpp"
#include "bench/method/jacobian/jacobian.hpp"
#include "bench/study/stability/stable_step.hpp"

namespace cvtflow::bench {

using namespace tasks;

std::vector<double> jacobian(const model::Variator& variator, double t, const std::vector<double>& state,
                             const std::vector<model::Phase>& phases) {
    return bench::difference_jacobian(variator, t, state, phases);
}

std::vector<std::complex<double>> spectrum(const model::Variator& variator, double t, const std::vector<double>& state,
                                           const std::vector<model::Phase>& phases) {
    return bench::eigenvalues(jacobian(variator, t, state, phases), static_cast<int>(state.size()));
}

namespace {

constexpr double nudge = 1e-4;  ///< relative change of saturation speeds, to first order: eigenvalues keep their order but for the closest

bench::Eigenvalues edge(const model::Parameters& parameters, const FrozenStart& start, double border) {
    const model::Variator variator(parameters);
    const int size = static_cast<int>(start.state.size());
    return bench::extremal_eigenvalues(jacobian(variator, start.time, start.state, start.phases), size, {.left_of = border, .progress = {}})
        .values;
}

void keep_left_of(bench::Eigenvalues& values, double border) {
    std::erase_if(values, [&](const auto& value) { return value.real() >= border; });
}

std::string names_of(const std::vector<int>& kinds) {
    std::vector<std::string_view> names;
    for (const int kind : kinds) names.push_back(contact_kinds()[static_cast<std::size_t>(kind)].name);
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::span<const ContactKind, contact_kind_count> contact_kinds() noexcept {
    static constexpr std::array<ContactKind, contact_kind_count> kinds{{
        {"joints", [](model::Parameters& p) -> model::Friction& { return p.joint.friction; }},
        {"plates", [](model::Parameters& p) -> model::Friction& { return p.plate.friction; }},
        {"tips", [](model::Parameters& p) -> model::Friction& { return p.tip.friction; }},
    }};
    return kinds;
}

Extent extent_of(const bench::Eigenvalues& values) noexcept {
    Extent extent;
    for (const auto& value : values) {
        extent.decay = std::max(extent.decay, -value.real());
        extent.oscillation = std::max(extent.oscillation, std::abs(value.imag()));
        extent.below_1e6 += value.real() < -1e6 ? 1 : 0;
        extent.below_1e7 += value.real() < -1e7 ? 1 : 0;
        extent.growing += value.real() > growth_rate_tolerance ? 1 : 0;
        extent.growth = std::max(extent.growth, value.real());
    }
    return extent;
}

int Attribution::main_kind(std::size_t value) const {
    const auto& of_value = shares[value];
    return static_cast<int>(std::max_element(of_value.begin(), of_value.end()) - of_value.begin());
}

Attribution attribute(const model::Parameters& parameters, const FrozenStart& start, double border,
                      const std::function<void(const std::string&)>& progress) {
    const auto tell = [&](const std::string& what) {
        if (progress) progress(what);
    };
    const auto kinds = contact_kinds();
    Attribution result;
    for (const std::vector<int>& chosen : std::vector<std::vector<int>>{{}, {0}, {1}, {2}, {0, 1}, {0, 1, 2}}) {
        model::Parameters changed = parameters;
        for (const int kind : chosen) kinds[static_cast<std::size_t>(kind)].friction(changed).saturation_speed *= 10.0;
        tell(chosen.empty() ? "the stiff part of the spectrum" : "saturation speeds x 10: " + names_of(chosen));
        result.slowed.push_back({names_of(chosen), edge(changed, start, border)});
    }
    result.values = result.slowed.front().values;
    keep_left_of(result.values, border);
    result.shares.resize(result.values.size());
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        model::Parameters changed = parameters;
        kinds[kind].friction(changed).saturation_speed *= 1.0 + nudge;
        tell(fmt::format("share of {}", kinds[kind].name));
        bench::Eigenvalues moved = edge(changed, start, border * (1.0 - 2.0 * nudge));  // those at the border must not get lost
        for (std::size_t k = 0; k < std::min(moved.size(), result.values.size()); ++k)
            result.shares[k][kind] = -std::log(std::abs(moved[k]) / std::abs(result.values[k])) / std::log1p(nudge);
    }
    return result;
}

}  // namespace cvtflow::bench
