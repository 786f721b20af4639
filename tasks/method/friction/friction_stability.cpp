#include "tasks/method/friction/friction_methods.hpp"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "tasks/method/friction/index.hpp"
#include "tasks/method/friction/staged/friction_leapfrog.hpp"

namespace cvtflow::tasks {

namespace {

constexpr int undisturbed = -1;

/// One kick, h = 1: v' = frictionless + extrapolation(t) change - friction v.
struct Kicked {
    double velocity, frictionless, change, friction;
    int disturbed = undisturbed;  ///< the stage whose velocity is off by 1
    double largest = 0.0;         ///< velocity of a stage, afterwards
    int stages = 0;               ///< afterwards
};

/// Velocity at the end.
using KickFunction = std::function<double(Kicked& kicked)>;

double explicit_kick(const KickTable& table, Kicked& kicked) {
    std::array<double, kick_state_slots> states{kicked.velocity};
    std::array<double, kick_slope_slots> slopes{};
    const auto combined = [&](const engine::PlanStep& row) {
        double sum = 0.0;
        for (const engine::Term& term : row.states) sum += term.factor * states[at(term.slot)];
        for (const engine::Term& term : row.slopes) sum += term.factor * slopes[at(term.slot)];
        return sum;
    };
    kicked.stages = table.plan.stages();
    for (int stage = 0; stage < kicked.stages; ++stage) {
        const engine::PlanStep row = table.plan.stage(stage);
        const double v = combined(row) + (stage == kicked.disturbed ? 1.0 : 0.0);
        kicked.largest = std::max(kicked.largest, std::abs(v));
        if (row.keep >= 0) states[at(row.keep)] = v;
        slopes[at(row.slope)] = kicked.frictionless + table.extrapolation(row.time, 1.0) * kicked.change - kicked.friction * v;
    }
    return combined(table.plan.result());
}

/// The error is one of what is solved for: friction acts on it.
double implicit_kick(const DirkTable& table, Kicked& kicked) {
    kicked.stages = static_cast<int>(table.times.size());
    std::vector<double> slopes;
    double v = 0.0;
    for (int stage = 0; stage < kicked.stages; ++stage) {
        const double frictionless = kicked.frictionless + table.extrapolation(stage, 1.0) * kicked.change;
        v = kicked.velocity + table.gamma * frictionless + (stage == kicked.disturbed ? 1.0 : 0.0);
        for (int other = 0; other < stage; ++other) v += table.weights[at(stage)][at(other)] * slopes[at(other)];
        v /= 1.0 + table.gamma * kicked.friction;
        kicked.largest = std::max(kicked.largest, std::abs(v));
        slopes.push_back(frictionless - kicked.friction * v);
    }
    return v;
}

template <int Size>
[[nodiscard]] double spectral_radius(const Eigen::Matrix<double, Size, Size>& step) {
    return step.allFinite() ? step.eigenvalues().cwiseAbs().maxCoeff() : std::numeric_limits<double>::infinity();
}

/// (q, v, frictionless of the step before) after one step.
[[nodiscard]] Eigen::Vector3d leapfrog(const KickFunction& kick, double oscillation, double friction, const Eigen::Vector3d& from) {
    const double frictionless = -oscillation * oscillation * (from(0) + 0.5 * from(1));
    Kicked kicked{from(1), frictionless, frictionless - from(2), friction};
    const double v = kick(kicked);
    return {from(0) + 0.5 * (from(1) + v), v, frictionless};
}

[[nodiscard]] StageFigures stage_figures(const KickFunction& kick, double friction) {
    StageFigures figures;
    Kicked plain{1.0, 0.0, 0.0, friction};
    figures.left = std::abs(kick(plain));
    figures.growth = plain.largest;
    for (int stage = 0; stage < plain.stages; ++stage) {
        Kicked off{0.0, 0.0, 0.0, friction, stage};
        figures.gain = std::max(figures.gain, std::abs(kick(off)));
    }
    return figures;
}

/// Largest h ω with that friction, 0 < h c: where the step has the eigenvalue -1, h²ω² = 2 (1 + R)/(B + 2 C), with R, B, C what a kick
/// makes of the velocity, of the frictionless and of its change.
[[nodiscard]] double oscillation_limit(const KickFunction& kick, double friction) {
    Kicked velocity{1.0, 0.0, 0.0, friction}, frictionless{0.0, 1.0, 0.0, friction}, change{0.0, 0.0, 1.0, friction};
    return std::sqrt(2.0 * (1.0 + kick(velocity)) / (kick(frictionless) + 2.0 * kick(change)));
}

/// @param kick that of a step which has stages for `stiffest`
[[nodiscard]] FrictionLimit oscillation_limit_up_to(const KickFunction& kick, double stiffest) {
    FrictionLimit limit{2.0, 0.0};  // without friction
    constexpr double least = 1e-2, ratio = 1.15;
    for (double friction = least; friction < ratio * stiffest; friction *= ratio) {
        const double here = std::min(friction, stiffest), oscillation = oscillation_limit(kick, here);
        if (oscillation < limit.oscillation) limit = {oscillation, here};
    }
    return limit;
}

[[nodiscard]] ProgramStability leapfrog_stability(const KickFunction& kick, double longest) {
    const auto radius = [kick, longest](double x, double y) {
        if (y > longest) return std::numeric_limits<double>::infinity();
        Eigen::Matrix3d step;
        for (int k = 0; k < 3; ++k) step.col(k) = leapfrog(kick, x, y, Eigen::Vector3d::Unit(k));
        return spectral_radius(step);
    };
    // Damping acts at the velocity v + (v - v before)/2 in the middle, as by Adams and Bashforth: -1 is an eigenvalue at h δ = 1.
    constexpr double longest_damping = 1.0;
    return {TestEquation::oscillator, radius, [kick](double decay) { return stage_figures(kick, decay); }, longest, longest_damping};
}

/// One additive step of the oscillator, h = 1, from (q, v).
struct AdditiveStep {
    double oscillation, friction;
    double damping = 0.0;         ///< explicit
    int disturbed = undisturbed;  ///< the stage whose velocity is off by 1 before its friction acts
    double largest = 0.0;         ///< velocity of a stage, afterwards

    [[nodiscard]] Eigen::Vector2d from(const AdditiveTable& table, const Eigen::Vector2d& begin);
};

Eigen::Vector2d AdditiveStep::from(const AdditiveTable& table, const Eigen::Vector2d& begin) {
    std::vector<Eigen::Vector2d> elastic, frictional;
    Eigen::Vector2d end = begin;
    for (int stage = 0; stage < table.stages(); ++stage) {
        Eigen::Vector2d y = begin;
        for (int other = 0; other < stage; ++other)
            y += table.explicit_part[at(stage)][at(other)] * elastic[at(other)] +
                 table.implicit_part[at(stage)][at(other)] * frictional[at(other)];
        if (stage == disturbed) y(1) += 1.0;
        if (stage > 0) y(1) /= 1.0 + table.gamma * friction;
        largest = std::max(largest, std::abs(y(1)));
        elastic.emplace_back(y(1), -oscillation * oscillation * y(0) - damping * y(1));
        frictional.emplace_back(0.0, -friction * y(1));
        end += table.weights[at(stage)] * (elastic.back() + frictional.back());
    }
    return end;
}

[[nodiscard]] StageFigures stage_figures(const AdditiveTable& table, double friction) {
    AdditiveStep plain{0.0, friction};
    StageFigures figures;
    figures.left = std::abs(plain.from(table, Eigen::Vector2d::UnitY())(1));
    figures.growth = plain.largest;
    for (int stage = 1; stage < table.stages(); ++stage)
        figures.gain = std::max(figures.gain, std::abs(AdditiveStep{0.0, friction, 0.0, stage}.from(table, Eigen::Vector2d::Zero())(1)));
    return figures;
}

/// Largest h δ with which a velocity does not grow.
[[nodiscard]] double longest_damping(const AdditiveTable& table) {
    constexpr double fine = 1e-3, far = 100.0;
    double damping = fine;
    while (damping < far && std::abs(AdditiveStep{0.0, 0.0, damping}.from(table, Eigen::Vector2d::UnitY())(1)) <= 1.0) damping += fine;
    return damping;
}

}  // namespace

ProgramStability leapfrog_stability(Kick kick) {
    const auto tables = std::make_shared<const KickTables>(kick);
    const double margin = FrictionLeapfrog<double>::margin;
    const auto run = [tables, margin](Kicked& kicked) { return explicit_kick(*tables->reaching(margin * kicked.friction), kicked); };
    ProgramStability stability = leapfrog_stability(run, tables->longest_reach() / margin * (1.0 - 1e-12));
    stability.beside = [tables, margin, longest = stability.longest_decay](double stiffest) {
        const KickTable* table = tables->reaching(margin * std::min(stiffest, longest));
        return oscillation_limit_up_to([table](Kicked& kicked) { return explicit_kick(*table, kicked); }, std::min(stiffest, longest));
    };
    return stability;
}

ProgramStability leapfrog_stability(const DirkTable& table) {
    const auto run = [table](Kicked& kicked) { return implicit_kick(table, kicked); };
    ProgramStability stability = leapfrog_stability(run, std::numeric_limits<double>::infinity());
    stability.beside = [run](double stiffest) { return oscillation_limit_up_to(run, stiffest); };
    return stability;
}

ProgramStability additive_stability(const AdditiveTable& table) {
    const auto radius = [table](double x, double y) {
        Eigen::Matrix2d step;
        for (int k = 0; k < 2; ++k) step.col(k) = AdditiveStep{x, y}.from(table, Eigen::Vector2d::Unit(k));
        return spectral_radius(step);
    };
    return {TestEquation::oscillator, radius, [table](double decay) { return stage_figures(table, decay); },
            std::numeric_limits<double>::infinity(), longest_damping(table)};
}

}  // namespace cvtflow::tasks
