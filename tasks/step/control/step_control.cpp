#include "tasks/step/control/step_control.hpp"

#include <algorithm>
#include <cmath>

#include "model/basis/portable_math.hpp"

namespace cvtflow::tasks {

namespace {

constexpr double safety = 0.9;
constexpr double proportional = 0.7, integral = 0.4;  // shares of 1/power
constexpr double min_growth = 0.2, max_growth = 2.0, min_cut = 0.1;
constexpr double smallest_error = 1e-6;

}  // namespace

double ErrorScale::norm(const double* errors, int size) const noexcept {
    double positions = 0.0, velocities = 0.0;
    for (int k = 0; k < size; ++k) positions += errors[k] * errors[k];
    for (int k = size; k < 2 * size; ++k) velocities += errors[k] * errors[k];
    return std::sqrt((positions / (coordinate * coordinate) + velocities / (velocity * velocity)) / (2.0 * size));
}

bool StepSizeControl::judge(double error, double step) noexcept {
    const double exponent = 1.0 / power_;
    if (!(error <= 1.0)) {
        const double cut = std::isfinite(error) ? safety * model::portable_pow(error, -exponent) : min_cut;
        proposal_ = step * std::clamp(cut, min_cut, safety);
        rejected_ = true;
        return false;
    }
    error = std::max(error, smallest_error);
    double growth = safety * model::portable_pow(error, -proportional * exponent) * model::portable_pow(previous_, integral * exponent);
    growth = std::clamp(growth, min_growth, rejected_ ? 1.0 : max_growth);
    // A step shortened to end at an output does not limit the next one.
    proposal_ = std::min(longest_, growth >= 1.0 ? std::max(proposal_, step * growth) : step * growth);
    previous_ = error;
    rejected_ = false;
    return true;
}

}  // namespace cvtflow::tasks
