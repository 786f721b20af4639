#include "tasks/run/step_advice.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/method/analysis/stability.hpp"
#include "engine/method/catalogue.hpp"
#include "tasks/method/method_choice.hpp"
#include "tasks/method/stability/krylov_space.hpp"
#include "tasks/method/stability/step_limit.hpp"

namespace cvtflow::tasks {

namespace {

/// Units in which an unknown counts as one: metres and radians in thousandths of metres per second, which makes a difference of 1e-9 m
/// small against contact depths and one of 1e-6 m/s small against saturation speeds at the same time. Eigenvalues do not depend on it.
constexpr double position_scale = 1e-3;
constexpr double difference = 1e-6;

/// The Jacobian as a linear map on scaled unknowns.
class Linearised {
public:
    Linearised(const model::Variator& variator, double t, const double* state, const std::vector<model::Phase>& phases)
        : variator_(variator),
          t_(t),
          phases_(phases),
          scratch_(variator.layout()),
          centre_(Eigen::Map<const Eigen::VectorXd>(state, variator.layout().size())),
          scale_(Eigen::VectorXd::Ones(variator.layout().size())),
          above_(centre_),
          below_(centre_) {
        const model::ChainLayout& at = variator.layout();
        for (int link = 0; link < at.links; ++link) scale_.segment(at.link_begin(link), at.link_size()).setConstant(position_scale);
        scale_.segment(at.pulley_begin(), at.pulley_size).setConstant(position_scale);
    }

    [[nodiscard]] Eigen::VectorXd operator()(const Eigen::VectorXd& direction) {
        const double length = difference / direction.cwiseAbs().maxCoeff();
        const Eigen::VectorXd shift = length * scale_.cwiseProduct(direction);
        return ((slope(centre_ + shift, above_) - slope(centre_ - shift, below_)) / (2.0 * length)).cwiseQuotient(scale_);
    }

private:
    [[nodiscard]] const Eigen::VectorXd& slope(const Eigen::VectorXd& at, Eigen::VectorXd& out) {
        model::right_hand_side(variator_, t_, at.data(), phases_.data(), out.data(), scratch_);
        return out;
    }

    const model::Variator& variator_;
    double t_;
    const std::vector<model::Phase>& phases_;
    model::EvaluationScratch scratch_;
    const Eigen::VectorXd centre_;
    Eigen::VectorXd scale_, above_, below_;
};

constexpr double min_damping = 1e-3;

[[nodiscard]] std::complex<double> direction_of(std::complex<double> value) {
    std::complex<double> direction = value / std::abs(value);
    if (direction.real() < -min_damping) return direction;
    return {-min_damping, std::sqrt(1.0 - min_damping * min_damping)};
}

}  // namespace

std::vector<std::complex<double>> extreme_eigenvalues(const model::Variator& variator, double t, const double* state,
                                                      const std::vector<model::Phase>& phases, int directions) {
    Linearised jacobian(variator, t, state, phases);
    const int size = variator.layout().size();
    KrylovSpace space(size, directions);
    const LinearMap map = [&](const double* from, double* to) {
        Eigen::Map<Eigen::VectorXd>(to, size) = jacobian(Eigen::Map<const Eigen::VectorXd>(from, size));
        return true;
    };
    while (!space.full()) {
        if (!space.grow(map)) return {};
    }
    std::vector<std::complex<double>> values = space.values();
    std::sort(values.begin(), values.end(), [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
    return values;
}

double largest_stable_step(std::string_view method, const std::vector<std::complex<double>>& eigenvalues) {
    double step = std::numeric_limits<double>::infinity();
    const engine::StagePlan* plan = engine::find_method(method);
    if (plan == nullptr) return step;
    constexpr std::size_t most = 12;           // outermost ones; those inside allow longer steps
    std::vector<std::complex<double>> looked;  // a scan takes a second with hundreds of stages, and most of these eigenvalues are real
    for (std::size_t k = 0; k < std::min(most, eigenvalues.size()); ++k) {
        const double size = std::abs(eigenvalues[k]);
        if (!(size > 0.0)) continue;
        const std::complex<double> direction = direction_of(eigenvalues[k]);
        const auto same = [&](const std::complex<double>& other) { return std::abs(other - direction) < 1e-6; };
        if (std::any_of(looked.begin(), looked.end(), same)) continue;  // one farther out in the same direction allows less
        looked.push_back(direction);
        step = std::min(step, engine::stability_reach(*plan, direction, 1e-6, step * size) / size);
    }
    return step;
}

double largest_stable_step(const model::Variator& variator, std::string_view method, double t, const double* state,
                           const std::vector<model::Phase>& phases) {
    if (find_program(method) == nullptr) return largest_stable_step(method, extreme_eigenvalues(variator, t, state, phases));
    StepLimitBound bound(variator, method);
    bound.look(t, state, phases.data());
    return bound.limit().step;
}

std::string unreliable_text(double suspicion, const AutoNumber& setting, double step) {
    return fmt::format("unreliable: the energy balance is off by {:.2g} times what an honest integration leaves; {} (run.step = {})",
                       suspicion,
                       setting.automatic() ? "\"auto\" does not hold here, a shorter step is needed" : "a shorter step is needed",
                       setting.automatic() ? fmt::format("{:.2g}, half of what it took", 0.5 * step) : "\"auto\", or less");
}

}  // namespace cvtflow::tasks
