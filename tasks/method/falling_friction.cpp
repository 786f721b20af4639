#include "tasks/method/falling_friction.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::tasks {

FallingFriction::FallingFriction(const model::Variator& variator, const model::Parameters& parameters)
    : variator_(variator), half_mass_(parameters.half.mass), observer_(variator) {}

/// From the saturation speed on in steps of 2 %, up to 10 m/s: tips do not slide faster in a machine that works.
double FallingFriction::steepest_fall() const noexcept {
    constexpr double ratio = 1.02, fastest = 10.0;  // [1], [m/s]
    const model::TipCoefficients& tip = variator_.chain().coefficients().tip;
    if (tip.law == nullptr) return 0.0;
    double steepest = 0.0, speed = tip.friction.saturation_speed, value = tip.law->by_speed.at(speed);
    while (speed < fastest) {
        const double next = tip.law->by_speed.at(speed * ratio);
        steepest = std::max(steepest, (value - next) / (speed * (ratio - 1.0)));
        speed *= ratio;
        value = next;
    }
    return tip.friction.coefficient * steepest;
}

double FallingFriction::growth(double t, const double* state, const model::Phase* phases) noexcept {
    const double fall = steepest_fall();
    if (!(fall > 0.0)) return 0.0;
    const auto& axial = observer_.observe(t, state, phases).tip_axial;
    double largest = 0.0;
    for (const double force : axial) largest = std::max(largest, std::abs(force));
    return 2.0 * largest * fall / half_mass_;
}

}  // namespace cvtflow::tasks
