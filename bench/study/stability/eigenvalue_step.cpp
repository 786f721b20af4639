#include "bench/study/stability/eigenvalue_step.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include "bench/method/analysis/stability.hpp"

namespace cvtflow::bench {

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
    const double stages = static_cast<double>(plan.stages.size());
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

}  // namespace cvtflow::bench
