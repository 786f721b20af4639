#include "bench/method/implicit/linear_plan.hpp"

#include <Eigen/LU>
#include <cmath>

namespace cvtflow::bench {

LinearTimes times_of(const LinearPlan& plan) {
    std::vector<double> increment;  // of time, in units of h: an unknown whose slope is 1 and that J knows nothing of
    const auto sum = [&](const std::vector<engine::Term>& terms) {
        double total = 0.0;
        for (const engine::Term& term : terms) total += term.factor * increment[static_cast<std::size_t>(term.slot)];
        return total;
    };
    LinearTimes times;
    for (const LinearStage& stage : plan.stages) {
        times.stage.push_back(sum(stage.states));
        increment.push_back(stage.gamma * (1.0 + sum(stage.right)));
    }
    times.result = sum(plan.result);
    return times;
}

LinearPlan steihaug_wolfbrandt() {
    const double gamma = 1.0 / (2.0 + std::sqrt(2.0));
    // As published: W k_1 = f(y), W k_2' = f(y + h k_1/2) - k_1, y⁺ = y + h (k_1 + k_2'); here u = γ h k.
    return {"sw2",
            "Steihaug-Wolfbrandt, linearly implicit: 2 stages, order 2 for any Jacobian, L-stable",
            "T. Steihaug, A. Wolfbrandt, Math. Comp. 33 (1979) 521-534",
            2,
            {{gamma, {}, {}}, {gamma, {{0, 0.5 / gamma}}, {{0, -1.0 / gamma}}}},
            {{0, 1.0 / gamma}, {1, 1.0 / gamma}}};
}

namespace {

/// Table in increments u = Γ k from one in slopes k (α, Γ, b as in the literature). In long double, which has no vectors: the same bits
/// however this is compiled.
LinearPlan transformed(const Eigen::MatrixXd& alpha, const Eigen::MatrixXd& gamma, const Eigen::RowVectorXd& weights) {
    using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    const Wide wide_inverse = Wide(gamma.cast<long double>()).inverse();
    const Eigen::MatrixXd inverse = wide_inverse.cast<double>();
    const Eigen::MatrixXd states = Wide(alpha.cast<long double>() * wide_inverse).cast<double>();
    const Eigen::RowVectorXd result = Wide(weights.cast<long double>() * wide_inverse).cast<double>().row(0);
    LinearPlan plan;
    for (Eigen::Index i = 0; i < alpha.rows(); ++i) {
        LinearStage stage{gamma(i, i), {}, {}};
        for (int j = 0; j < i; ++j) {
            if (states(i, j) != 0.0) stage.states.push_back({j, states(i, j)});
            if (inverse(i, j) != 0.0) stage.right.push_back({j, -inverse(i, j)});
        }
        plan.stages.push_back(stage);
        plan.result.push_back({static_cast<int>(i), result(i)});
    }
    return plan;
}

}  // namespace

LinearPlan ros34pw2() {
    constexpr double g = 0.435866521508459;
    Eigen::MatrixXd alpha(4, 4), gamma(4, 4);
    Eigen::RowVectorXd weights(4);
    alpha << 0, 0, 0, 0, 0.871733043016918, 0, 0, 0, 0.8445706001536942, -0.11299064236484185, 0, 0, 0, 0, 1, 0;
    gamma << g, 0, 0, 0, -0.871733043016918, g, 0, 0, -0.9033805701304408, 0.054180672388095326, g, 0, 0.24212380706095346,
        -1.2232505839045147, 0.5452602553351021, g;
    weights << 0.24212380706095346, -1.2232505839045147, 1.545260255335102, g;
    LinearPlan plan = transformed(alpha, gamma, weights);
    plan.name = "ros34pw2";
    plan.description = "ROS34PW2, linearly implicit: 4 stages, order 3 for any Jacobian, L-stable";
    plan.source = "J. Rang, L. Angermann, BIT 45 (2005) 761-787";
    plan.order = 3;
    return plan;
}

namespace {

/// Weight of the solution with n substeps among 1 … order: Aitken-Neville for an error expansion in powers of h/n.
[[nodiscard]] double extrapolation_weight(int n, int order) {
    double weight = 1.0;
    for (int other = 1; other <= order; ++other) {
        if (other != n) weight *= static_cast<double>(n) / (n - other);
    }
    return weight;
}

}  // namespace

LinearPlan extrapolated_w(int order) {
    LinearPlan plan;
    plan.name = "w-x" + std::to_string(order);
    plan.description = "linearly implicit Euler with Richardson extrapolation over 1 … " + std::to_string(order) + " substeps, order " +
                       std::to_string(order) + " for any Jacobian";
    plan.source = "E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.9";
    plan.order = order;
    for (int n = 1; n <= order; ++n) {
        const int first = static_cast<int>(plan.stages.size());
        for (int substep = 0; substep < n; ++substep) {
            LinearStage stage{1.0 / n, {}, {}};
            for (int done = 0; done < substep; ++done) stage.states.push_back({first + done, 1.0});
            plan.stages.push_back(stage);
            plan.result.push_back({first + substep, extrapolation_weight(n, order)});
        }
    }
    return plan;
}

const std::vector<LinearPlan>& linear_plans() {
    static const std::vector<LinearPlan> all{steihaug_wolfbrandt(), ros34pw2(), extrapolated_w(2), extrapolated_w(3), extrapolated_w(4)};
    return all;
}

}  // namespace cvtflow::bench
