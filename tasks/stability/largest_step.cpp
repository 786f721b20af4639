#include "tasks/stability/largest_step.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <stdexcept>

#include "engine/method/catalogue.hpp"
#include "tasks/method_choice.hpp"
#include "tasks/stability/growth.hpp"
#include "tasks/stability/real_step.hpp"
#include "tasks/stability/step_map.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double longer = 1.12, precision = 1.003;   ///< of steps tried next; between the longest stable one and the shortest that is not
constexpr double first_try = 0.85;                   ///< of what is expected
constexpr double shortest_tried = 1e-9, longest_of_all = 1e-2;   ///< of methods with a limit [s]
constexpr double without_expectation = 1e-6;         ///< first step tried of a method without limit [s]
constexpr int states_in_a_row = 3;

/// Two steps, stable and not; the second one infinite if none was unstable.
struct Bracket {
    double stable = 0.0, unstable = std::numeric_limits<double>::infinity();
};

[[nodiscard]] Bracket bracketed(double expected, const std::function<bool(double)>& stable) {
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

[[nodiscard]] std::unique_ptr<StepMap> map_of(const LinearChain& chain, std::string_view method) {
    if (const MethodProgram* program = find_program(method)) return program->linear(chain);
    const auto plan = engine::make_method(method);
    if (!plan) throw std::invalid_argument(no_method(method));
    return table_step(chain, engine::CompiledPlan(*plan));
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

/// x* M x of a link.
[[nodiscard]] double energy_of(const model::LinkInertia& inertia, int lateral, const double* x) {
    const auto form = [](const double* matrix, int size, const double* y) {
        double sum = 0.0;
        for (int row = 0; row < size; ++row) {
            for (int column = 0; column < size; ++column) sum += matrix[row * size + column] * y[row] * y[column];
        }
        return sum;
    };
    return form(inertia.lateral_matrix.data(), lateral, x) + form(inertia.lateral_matrix.data(), lateral, x + lateral) +
           form(inertia.axial_matrix.data(), 4, x + 2 * lateral);
}

/// Share of an eigenvector's kinetic energy.
[[nodiscard]] double share_of_pulleys(const LinearChain& chain, const Growth& growth) {
    const model::Variator& variator = chain.variator();
    const model::ChainLayout& layout = variator.layout();
    double links = 0.0, pulleys = 0.0;
    for (const std::vector<double>* half : {&growth.real, &growth.imaginary}) {
        const double* v = half->data() + chain.coordinates();
        for (int link = 0; link < layout.links; ++link) links += energy_of(variator.chain().inertia(), 2 * layout.lateral(), v + link * layout.link_size());
        for (int k = 0; k < layout.pulley_size; ++k) pulleys += variator.pulleys().inertia(k) * v[chain.link_velocities() + k] * v[chain.link_velocities() + k];
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

StepLimit predicted_step_limit(const LinearChain& chain, std::string_view method, double expected) {
    const std::unique_ptr<StepMap> map = map_of(chain, method);
    if (expected == 0.0) {
        StepLimitBound bound(chain.variator(), method);
        bound.look(chain.start().time, chain.start().state.data(), chain.start().phases.data());
        expected = bound.limit().step;
    }
    const MethodProgram* program = find_program(method);
    if (program != nullptr && program->stability == nullptr && std::isinf(expected)) expected = without_expectation;   // it has one, but only tables know it
    Growth beyond;   // at the shortest unstable step so far
    bool refused = false;
    const auto stable = [&](double h) {
        refused = !map->prepare(h);
        if (refused) return false;
        Growth growth = fastest_growth(map->size(), [&](const double* from, double* to) { map->step(from, to); return true; }, beyond.real);
        if (growth.factor <= 1.0 + tolerated_growth) return true;
        beyond = std::move(growth);
        return false;
    };
    const Bracket bracket = bracketed(expected, stable);
    if (std::isinf(bracket.unstable)) return {};
    const bool apart = program != nullptr && program->stability != nullptr;
    const double step = std::sqrt(bracket.stable * bracket.unstable);
    if (refused || beyond.real.empty()) return {step, apart ? StepLimiter::friction_stages : StepLimiter::polynomials, 0.0, chain.stiffest_friction(), 0.0};
    return explained(chain, step, beyond, apart);
}

double predicted_growth(const LinearChain& chain, std::string_view method, double h) {
    const std::unique_ptr<StepMap> map = map_of(chain, method);
    if (!map->prepare(h)) return std::numeric_limits<double>::infinity();
    return fastest_growth(map->size(), [&](const double* from, double* to) { map->step(from, to); return true; }, {}).factor;
}

StepLimit predicted_step_limit(const model::Variator& variator, const model::Parameters& parameters, std::string_view method, const FrozenStart& start) {
    return predicted_step_limit(LinearChain(variator, parameters, start), method);
}

namespace {

[[nodiscard]] std::unique_ptr<TakenStep> taken_step(const Scene& scene, const model::Variator& variator, std::string_view method, const FrozenStart& start) {
    if (find_program(method) == nullptr) return std::make_unique<HeldStep>(variator, *engine::make_method(method), start);
    return std::make_unique<RealStep>(scene, method, start);
}

}  // namespace

MeasuredLimit measured_step_limit(const Scene& scene, std::string_view method, const FrozenStart& start, double expected) {
    const model::Variator variator(scene.parameters);
    const std::unique_ptr<TakenStep> taken = taken_step(scene, variator, method, start);
    TakenStep& step = *taken;
    MeasuredLimit limit;
    const auto stable = [&](double h) {
        limit.refused = !step.prepare(h);
        if (limit.refused) return false;
        for (int state = 0; state < states_in_a_row; ++state) {
            const auto map = [&](const double* from, double* to) { return step.step(from, to); };
            if (fastest_growth(step.size(), map, step.mixed_start()).factor <= 1.0 + tolerated_growth) return true;
            if (!step.move_on()) return false;
        }
        return false;
    };
    const Bracket bracket = bracketed(expected, stable);
    limit.step = std::isinf(bracket.unstable) ? bracket.unstable : std::sqrt(bracket.stable * bracket.unstable);
    limit.refused = limit.refused && !std::isinf(limit.step);
    return limit;
}

}  // namespace cvtflow::tasks
