#include "bench/study/stability/stable_step.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>
#include <vector>

#include "bench/method/analysis/stability.hpp"

namespace cvtflow::bench {

using namespace tasks;

namespace {

using Complex = std::complex<double>;

class Judge {
public:
    Judge(const engine::StagePlan& plan, std::span<const Complex> eigenvalues) : factor_(bench::stability_function(plan)) {
        for (const Complex& value : eigenvalues) {
            if (value.imag() >= 0.0 && value != 0.0) values_.push_back(value);
        }
        // The largest leave the region first, as a rule: an unstable step is found out at once.
        std::sort(values_.begin(), values_.end(), [](const Complex& a, const Complex& b) { return std::abs(a) > std::abs(b); });
        if (values_.empty()) throw std::invalid_argument(plan.name + ": without an eigenvalue besides 0 every step is stable");
    }

    [[nodiscard]] double largest() const { return std::abs(values_.front()); }

    /// The first eigenvalue whose mode grows.
    [[nodiscard]] std::optional<Complex> growing(double h) {
        for (const Complex& value : values_) {
            // A consistent method has R(z) = exp(z) + O(z²): a slow disturbance cannot grow by more than is tolerated.
            if (h * std::norm(value) < 0.5 * growth_rate_tolerance) continue;
            const double rate = std::log(std::abs(factor_(h * value))) / h;
            if (!(rate <= std::max(value.real(), 0.0) + growth_rate_tolerance)) return value;
        }
        return {};
    }

private:
    std::function<Complex(Complex)> factor_;
    std::vector<Complex> values_;
};

}  // namespace

StableStep largest_stable_step(const engine::StagePlan& plan, std::span<const std::complex<double>> eigenvalues) {
    Judge judge(plan, eigenvalues);
    const auto stages = static_cast<double>(plan.stages.size());
    double stable = 0.0, unstable = 0.1 / judge.largest();
    const double longest =
        (2.0 * stages * stages + 10.0) / judge.largest();  // no consistent explicit method reaches further on the real axis
    std::optional<Complex> limiting;
    while (!(limiting = judge.growing(unstable)) && unstable < longest) stable = unstable, unstable *= 1.01;
    if (!limiting) return {unstable, {}};
    for (int halving = 0; halving < 40 && unstable - stable > 1e-7 * unstable; ++halving) {
        const double middle = 0.5 * (stable + unstable);
        const auto growing = judge.growing(middle);
        if (growing) limiting = growing;
        (growing ? unstable : stable) = middle;
    }
    return {stable, *limiting};
}

namespace {

constexpr double first_disturbance = 1e-9;  ///< [m/s]; rounding of positions makes 1e-11

/// Largest change of a velocity of the links.
double size_of(const model::ChainLayout& at, const std::vector<double>& state, const std::vector<double>& still) {
    double largest = 0.0;
    for (int link = 0; link < at.links; ++link) {
        for (int k = at.link_size(); k < at.link_block(); ++k) {
            const auto index = static_cast<std::size_t>(at.link_begin(link) + k);
            const double change = std::abs(state[index] - still[index]);
            largest = std::isfinite(change) ? std::max(largest, change) : INFINITY;
        }
    }
    return largest;
}

std::vector<double> disturbed(const model::ChainLayout& at, std::vector<double> state) {
    std::mt19937_64 random(7);
    for (int link = 0; link < at.links; ++link) {
        for (int k = at.link_size(); k < at.link_block(); ++k)
            state[static_cast<std::size_t>(at.link_begin(link) + k)] += (random() & 1) != 0 ? first_disturbance : -first_disturbance;
    }
    return state;
}

}  // namespace

bool disturbance_grows(const model::Variator& variator, const engine::StagePlan& plan, const FrozenStart& start, double h, int steps,
                       double natural_growth) {
    FrozenStepper stepper(variator, plan, start.phases);
    stepper.hold(start.time, start.state);
    std::vector<double> state = disturbed(variator.layout(), start.state);
    const auto large = [&](int count) {
        stepper.advance(start.time, h, count, state);
        return size_of(variator.layout(), state, start.state);
    };
    const double natural = std::exp(0.5 * natural_growth * steps * h);  // in half the time
    const double middle = large(steps / 2);
    if (middle > 1e3 * natural * first_disturbance) return true;
    const double end = large(steps - steps / 2);
    return end > 1e3 * natural * natural * first_disturbance || end > 2.0 * natural * middle;
}

MeasuredStep measured_stable_step(const model::Variator& variator, const engine::StagePlan& plan, const FrozenStart& start, double expected,
                                  double natural_growth) {
    const int stages = static_cast<int>(plan.stages.size());
    const int steps = std::clamp(30000 / stages, 100, 2000);
    MeasuredStep found{0.6 * expected, 1.6 * expected, 0};
    const auto grows = [&](double h) {
        found.evaluations += static_cast<long>(steps) * stages;
        return disturbance_grows(variator, plan, start, h, steps, natural_growth);
    };
    if (grows(found.stable)) return {0.0, found.stable, found.evaluations};
    if (!grows(found.unstable)) return {found.unstable, 0.0, found.evaluations};
    while (found.unstable - found.stable > 0.005 * found.stable) {
        const double middle = 0.5 * (found.stable + found.unstable);
        (grows(middle) ? found.unstable : found.stable) = middle;
    }
    return found;
}

}  // namespace cvtflow::bench
