#include "tasks/step/control/error_control.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tasks/step/method_memory.hpp"

namespace cvtflow::tasks {

namespace {

[[nodiscard]] double longest_step(const StepSettings& settings) noexcept {
    return settings.automatic() ? settings.output_interval : std::min(settings.step, settings.output_interval);
}

}  // namespace

ErrorControl::ErrorControl(Workspace& workspace, const StepMethod& method, const StepSettings& settings)
    : w_(workspace),
      estimates_(settings.control != StepControl::fixed),
      decides_(settings.control == StepControl::error),
      tolerance_(settings.tolerance),
      size_(longest_step(settings), std::max(1, method.error_power())) {
    if (estimates_ && method.error_power() == 0)
        throw std::invalid_argument("this method has no error estimate: run.step_control must be \"fixed\"");
    w_.step.estimate_error = estimates_;
}

void ErrorControl::prepare(const StepMethod& method) const {
    if (estimates_) w_.step.error_row = *method.error_row();
}

bool ErrorControl::accepts(bool retaken) {
    const bool counts = estimates_ && !retaken;
    const double error = counts ? step_error() : 0.0;
    if (decides_ && !size_.judge(error / tolerance_, w_.step.h)) return false;
    if (counts) {
        ++statistics_.steps;
        statistics_.sum += error;
        statistics_.largest = std::max(statistics_.largest, error);
    }
    return true;
}

/// Local error of the step, the largest of all links and of the pulleys; not a number if an estimate is not finite.
double ErrorControl::step_error() const {
    const model::ChainLayout& at = w_.layout();
    double largest = 0.0;
    if (at.pulley_size != 0) {
        engine::combine(w_.step.error_row, w_.step.h, w_.slots(), at.pulley_begin(), at.pulley_begin() + 2 * at.pulley_size,
                        w_.pulleys.tail.data());
        largest = w_.step.error_scale.norm(w_.pulleys.tail.data(), at.pulley_size);
        if (!std::isfinite(largest)) return largest;
    }
    for (const double error : w_.links.errors) {
        if (!std::isfinite(error)) return error;
        largest = std::max(largest, error);
    }
    return largest;
}

void ErrorControl::save(std::vector<double>& memory) const {
    if (!decides_) return;
    const auto size = size_.save();
    memory.insert(memory.begin(), size.begin(), size.end());
}

void ErrorControl::load(std::span<const double>& memory) {
    if (decides_) size_.load(pop_front(memory, StepSizeControl::memory_size));
}

}  // namespace cvtflow::tasks
