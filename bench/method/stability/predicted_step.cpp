#include "bench/method/stability/predicted_step.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <numeric>

#include "bench/method/laboratory_methods.hpp"
#include "bench/method/stability/growth.hpp"
#include "bench/method/stability/step_map.hpp"
#include "engine/method/compiled_plan.hpp"
#include "model/basis/portable_math.hpp"

namespace cvtflow::bench {

namespace {

constexpr double longer = 1.12, precision = 1.003;              ///< factor between trial steps; final ratio of unstable to stable step
constexpr double first_try = 0.85;                              ///< first trial step over the expected limit
constexpr double shortest_tried = 1e-9, longest_of_all = 1e-2;  ///< range of trial steps for methods with a limit [s]

}  // namespace

Bracket bracketed(double expected, const std::function<bool(double)>& stable) {
    const bool limited = std::isfinite(expected) && expected > 0.0;
    const double factor = limited ? longer : 2.0, longest = limited ? longest_of_all : longest_tried;
    Bracket bracket;
    double h = limited ? first_try * expected : without_expectation;
    while (!stable(h)) {
        bracket.unstable = h;
        h /= longer * longer;
        if (h < shortest_tried) return bracket;
    }
    bracket.stable = h;
    while (std::isinf(bracket.unstable) && bracket.stable < longest) {
        h = factor * bracket.stable;
        (stable(h) ? bracket.stable : bracket.unstable) = h;
    }
    if (std::isinf(bracket.unstable)) return bracket;
    while (bracket.unstable > precision * bracket.stable) {
        const double middle = std::sqrt(bracket.stable * bracket.unstable);
        (stable(middle) ? bracket.stable : bracket.unstable) = middle;
    }
    return bracket;
}

namespace {

[[nodiscard]] std::unique_ptr<StepMap> map_of(const LinearChain& chain, const Method& method) {
    if (method.program() != nullptr) return analysis_of(*method.program()).linear(chain);
    return table_step(chain, engine::CompiledPlan(method.plan()));
}

/// Σ x* part(x) / Σ |x|² of an eigenvector's coordinates: the part's eigenvalue, if it is one.
using AddPart = void (LinearChain::*)(double, const double*, double*) const;
[[nodiscard]] double quotient(const LinearChain& chain, const Growth& growth, AddPart part) {
    double above = 0.0, below = 0.0;
    for (const std::vector<double>* half : {&growth.real, &growth.imaginary}) {
        std::vector<double> x(half->begin(), half->begin() + chain.coordinates()), image(static_cast<std::size_t>(chain.velocities()), 0.0);
        x.resize(image.size(), 0.0);
        (chain.*part)(1.0, x.data(), image.data());
        for (int k = 0; k < chain.coordinates(); ++k) {
            above += x[static_cast<std::size_t>(k)] * image[static_cast<std::size_t>(k)];
            below += x[static_cast<std::size_t>(k)] * x[static_cast<std::size_t>(k)];
        }
    }
    return above / below;
}

/// Share of an eigenvector's kinetic energy.
[[nodiscard]] double share_of_pulleys(const LinearChain& chain, const Growth& growth) {
    const model::Variator& variator = chain.variator();
    const model::ChainLayout& layout = variator.layout();
    double links = 0.0, pulleys = 0.0;
    for (const std::vector<double>* half : {&growth.real, &growth.imaginary}) {
        const double* v = half->data() + chain.coordinates();
        for (int link = 0; link < layout.links; ++link)
            links += 2.0 * model::kinetic_energy(variator.chain().inertia(), v + link * layout.link_size());
        for (int k = 0; k < layout.pulley_size; ++k)
            pulleys += variator.pulleys().inertia(k) * v[chain.link_velocities() + k] * v[chain.link_velocities() + k];
    }
    return pulleys / (links + pulleys);
}

[[nodiscard]] StepLimit explained(const LinearChain& chain, double step, const Growth& growth, bool takes_friction_apart) {
    StepLimit limit{step, StepLimiter::oscillation, std::sqrt(std::max(0.0, -quotient(chain, growth, &LinearChain::add_elastic))),
                    std::max(0.0, -quotient(chain, growth, &LinearChain::add_friction)), share_of_pulleys(chain, growth)};
    const double damping = std::max(0.0, -quotient(chain, growth, &LinearChain::add_damping));
    if (limit.oscillation < damping + (takes_friction_apart ? 0.0 : limit.friction)) {
        limit.by = StepLimiter::decay;
        limit.friction += damping;
    }
    return limit;
}

/// Where a step near its limit is likely to grow: the fastest oscillation, with a share of everything. From there Arnoldi's method needs a
/// quarter of the directions.
[[nodiscard]] std::vector<double> likely_growth(const LinearChain& chain, int size) {
    constexpr int iterations = 60;
    constexpr double share_of_others = 0.05;
    const auto coordinates = static_cast<std::size_t>(chain.coordinates());
    const auto other = [](std::size_t k) { return model::portable_sin(1.0 + 12.9898 * static_cast<double>((k + 1) * (k % 7 + 1))); };
    std::vector<double> x(coordinates), image(static_cast<std::size_t>(chain.velocities()));
    for (std::size_t k = 0; k < coordinates; ++k) x[k] = other(k);
    for (int iteration = 0; iteration < iterations; ++iteration) {
        std::ranges::fill(image, 0.0);
        chain.add_elastic(1.0, x.data(), image.data());
        const double length = std::sqrt(std::inner_product(image.begin(), image.begin() + chain.coordinates(), image.begin(), 0.0));
        if (!(length > 0.0)) break;
        for (std::size_t k = 0; k < coordinates; ++k) x[k] = image[k] / length;
    }
    x.resize(static_cast<std::size_t>(size), 0.0);
    const double share = share_of_others / std::sqrt(static_cast<double>(size));
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += share * other(k);
    return x;
}

}  // namespace

StepLimit predicted_step_limit(const LinearChain& chain, const Method& method, double expected) {
    const std::unique_ptr<StepMap> map = map_of(chain, method);
    const FrozenStart& start = chain.start();
    if (expected == 0.0)
        expected = estimated_step_limit(chain.variator(), method, start.time, start.state.data(), start.phases.data()).step;
    const MethodProgram* program = method.program();
    if (program != nullptr && analysis_of(*program).stability == nullptr && std::isinf(expected))
        expected = without_expectation;  // it has one, but only tables know it
    Growth beyond;                       // at the shortest unstable step so far
    bool refused = false;
    const auto stable = [&](double h) {
        refused = !map->prepare(h);
        if (refused) return false;
        Growth growth = fastest_growth(
            map->size(),
            [&](const double* from, double* to) {
                map->step(from, to);
                return true;
            },
            beyond.real);
        if (growth.certain() <= 1.0 + growth_factor_tolerance) return true;
        beyond = std::move(growth);
        return false;
    };
    const Bracket bracket = bracketed(expected, stable);
    if (std::isinf(bracket.unstable)) return {};
    const bool apart = program != nullptr && analysis_of(*program).stability != nullptr;
    const double step = std::sqrt(bracket.stable * bracket.unstable);
    if (refused || beyond.real.empty())
        return {step, apart ? StepLimiter::friction_stages : StepLimiter::polynomials, 0.0, chain.stiffest_friction(), 0.0};
    return explained(chain, step, beyond, apart);
}

double predicted_growth(const LinearChain& chain, const Method& method, double h) {
    const std::unique_ptr<StepMap> map = map_of(chain, method);
    if (!map->prepare(h)) return std::numeric_limits<double>::infinity();
    constexpr int few_directions = 40;
    const GrowthSettings settings{.most = few_directions};
    const auto step = [&](const double* from, double* to) {
        map->step(from, to);
        return true;
    };
    const double likely = fastest_growth(map->size(), step, likely_growth(chain, map->size()), settings).certain();
    return std::max(likely, fastest_growth(map->size(), step, {}, settings).certain());
}

StepLimit predicted_step_limit(const model::Variator& variator, const model::Parameters& parameters, const Method& method,
                               const FrozenStart& start) {
    return predicted_step_limit(LinearChain(variator, parameters, start), method);
}

}  // namespace cvtflow::bench
