#include "tasks/method/stability/predicted_step.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>

#include "engine/method/compiled_plan.hpp"
#include "tasks/method/stability/growth.hpp"
#include "tasks/method/stability/step_map.hpp"
#include "tasks/method/stability/step_search.hpp"

namespace cvtflow::tasks {

namespace {

[[nodiscard]] std::unique_ptr<StepMap> map_of(const LinearChain& chain, const Method& method) {
    if (method.program() != nullptr) return method.program()->linear(chain);
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

}  // namespace

StepLimit predicted_step_limit(const LinearChain& chain, const Method& method, double expected) {
    const std::unique_ptr<StepMap> map = map_of(chain, method);
    const FrozenStart& start = chain.start();
    if (expected == 0.0)
        expected = estimated_step_limit(chain.variator(), method, start.time, start.state.data(), start.phases.data()).step;
    const MethodProgram* program = method.program();
    if (program != nullptr && program->stability == nullptr && std::isinf(expected))
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
    const bool apart = program != nullptr && program->stability != nullptr;
    const double step = std::sqrt(bracket.stable * bracket.unstable);
    if (refused || beyond.real.empty())
        return {step, apart ? StepLimiter::friction_stages : StepLimiter::polynomials, 0.0, chain.stiffest_friction(), 0.0};
    return explained(chain, step, beyond, apart);
}

double predicted_growth(const LinearChain& chain, const Method& method, double h) {
    const std::unique_ptr<StepMap> map = map_of(chain, method);
    if (!map->prepare(h)) return std::numeric_limits<double>::infinity();
    return fastest_growth(map->size(),
                          [&](const double* from, double* to) {
                              map->step(from, to);
                              return true;
                          },
                          {})
        .certain();
}

StepLimit predicted_step_limit(const model::Variator& variator, const model::Parameters& parameters, const Method& method,
                               const FrozenStart& start) {
    return predicted_step_limit(LinearChain(variator, parameters, start), method);
}

}  // namespace cvtflow::tasks
