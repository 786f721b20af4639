#include "bench/study/stability/measured_step.hpp"

#include <cmath>

#include "bench/method/stability/growth.hpp"
#include "bench/method/stability/step_search.hpp"
#include "bench/study/stability/real_step.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

constexpr int states_in_a_row = 3;

[[nodiscard]] std::unique_ptr<TakenStep> taken_step(const Scene& scene, const model::Variator& variator, std::string_view method,
                                                    const FrozenStart& start) {
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
            if (fastest_growth(step.size(), map, step.mixed_start()).factor <= 1.0 + growth_factor_tolerance) return true;
            if (!step.move_on()) return false;
        }
        return false;
    };
    const Bracket bracket = bracketed(expected, stable);
    limit.step = std::isinf(bracket.unstable) ? bracket.unstable : std::sqrt(bracket.stable * bracket.unstable);
    limit.refused = limit.refused && !std::isinf(limit.step);
    return limit;
}

}  // namespace cvtflow::bench
