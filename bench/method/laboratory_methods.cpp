#include "bench/method/laboratory_methods.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "bench/method/analysis/stability.hpp"
#include "bench/method/family/families.hpp"
#include "bench/method/fitted_method.hpp"
#include "bench/method/implicit/catalogue.hpp"
#include "engine/thread/guards.hpp"
#include "tasks/method/method.hpp"

namespace cvtflow::bench {

namespace {

/// Programs that choose among tables of stages by the spectrum.
[[nodiscard]] std::vector<MethodProgram> spectral_programs() {
    return {
        {.name = "rkc",
         .description = "Runge-Kutta-Chebyshev, stages by the spectrum",
         .source = "Sommeijer, Shampine, Verwer, J. Comput. Appl. Math. 88 (1998) 315-326",
         .order = 2,
         .state_slots = 4,
         .slope_slots = 3,
         .make = rkc_by_spectrum,
         .estimates_error = true},
        {.name = "fitted",
         .description = "polynomial fitted to the spectrum, repeated when it changes",
         .source = "weights by Lawson's iteration",
         .order = 3,
         .state_slots = FittedChoice::max_stages + 1,
         .slope_slots = 3,
         .make = fitted_by_spectrum,
         .estimates_error = true},
    };
}

[[nodiscard]] std::vector<MethodProgram> all_programs() {
    std::vector<MethodProgram> all;
    for (const auto& some : {spectral_programs(), implicit_programs()}) all.insert(all.end(), some.begin(), some.end());
    return all;
}

/// Elastic oscillations are damped by this share of the critical damping at least.
constexpr double min_damping = 1e-3;
/// Permitted numerical damping of an oscillation in a step, over h ω: a hundredth of the effect of a damping ratio of 0.01.
constexpr double max_damping = 1e-4;

/// |h λ| along the ray of that damping ratio.
[[nodiscard]] double along_ray(const StagePlan& plan, double damping) {
    return stability_reach(plan, {-damping, std::sqrt(1.0 - damping * damping)}, 1e-6);
}

/// Derived once for each name, which takes a while.
[[nodiscard]] StageReach known_reach(const StagePlan& plan) {
    static engine::Mutex mutex;
    static std::map<std::string, StageReach> known;
    return mutex.guard([&] {
        const auto found = known.find(plan.name);
        return found != known.end() ? found->second : known.emplace(plan.name, derived_reach(plan)).first->second;
    });
}

/// Largest h ω up to which a table damps oscillations by no more than that.
[[nodiscard]] double accurate_oscillation(const StagePlan& plan, double stable) {
    constexpr double fine = 0.01;
    const auto function = stability_function(plan);
    double y = fine;
    while (y < stable && std::abs(function({0.0, y})) >= 1.0 - max_damping * y) y += fine;
    return y;
}

}  // namespace

void add_laboratory_methods() {
    static const bool once = [] {
        tasks::add_methods({{further_tables, family_examples, families()}, all_programs, known_reach});
        return true;
    }();
    (void)once;
}

StageReach derived_reach(const StagePlan& plan) {
    StageReach reach{along_ray(plan, min_damping), real_stability(plan), 0.0, along_ray(plan, 1e-2)};
    reach.accurate = accurate_oscillation(plan, reach.oscillation);
    return reach;
}

}  // namespace cvtflow::bench
