#include "bench/method/stability/program_stability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "bench/method/product_names.hpp"
#include "tasks/method/friction/friction_leapfrog.hpp"

namespace cvtflow::bench {

namespace {

constexpr double finest = 0.01, finer = 1.01;
constexpr double min_decay = 1e-2, decay_ratio = 1.15;  ///< grid of decays

/// Calls `visit` with decays from min_decay to the longest one.
template <class Visit>
void over_decays(const ProgramStability& method, Visit visit) {
    const double longest = std::min(method.longest_decay, far_away);
    for (double decay = min_decay; decay < longest; decay *= decay_ratio) visit(decay);
    visit(longest);
}

}  // namespace

double reach(const ProgramStability& method, double x, double y, double along_x, double along_y, double enough) {
    const auto stable = [&](double r) { return method.stable(x + r * along_x, y + r * along_y); };
    double inside = 0.0, outside = finest;
    while (stable(outside)) {
        inside = outside;
        if (inside > far_away) return std::numeric_limits<double>::infinity();
        if (inside >= enough) return inside;
        outside = std::max(outside + finest, finer * outside);
    }
    for (int halving = 0; halving < 40; ++halving) {
        const double middle = 0.5 * (inside + outside);
        (stable(middle) ? inside : outside) = middle;
    }
    return inside;
}

FrictionLimit limit_with_any_friction(const ProgramStability& method) {
    FrictionLimit limit{reach(method, 0.0, 0.0, 1.0, 0.0), 0.0};
    over_decays(method, [&](double friction) {
        const double oscillation = reach(method, 0.0, friction, 1.0, 0.0, limit.oscillation);
        if (oscillation < limit.oscillation) limit = {oscillation, friction};
    });
    return limit;
}

StageFigures worst_stages(const ProgramStability& method) {
    StageFigures worst;
    over_decays(method, [&](double decay) {
        const StageFigures here = method.stages(decay);
        worst = {std::max(worst.growth, here.growth), std::max(worst.gain, here.gain), here.left};
    });
    return worst;
}

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

/// Backward Euler, one stage. The error is in the equation to solve: friction acts on it.
double backward_euler_kick(Kicked& kicked) {
    kicked.stages = 1;
    const double v = (kicked.velocity + kicked.frictionless + (kicked.disturbed == 0 ? 1.0 : 0.0)) / (1.0 + kicked.friction);
    kicked.largest = std::max(kicked.largest, std::abs(v));
    return v;
}

[[nodiscard]] double spectral_radius(const Eigen::Matrix3d& step) {
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

/// Largest h ω with that friction, 0 < h c: where the step has the eigenvalue -1, h²ω² = 2 (1 + R)/(B + 2 C), with R, B, C the results of a
/// kick from the velocity, the frictionless part and its change.
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

}  // namespace

ProgramStability leapfrog_stability(const Kick& kick) {
    const auto tables = std::make_shared<const KickTables>(kick);
    const double margin = FrictionLeapfrog::margin;
    const auto run = [tables, margin](Kicked& kicked) { return explicit_kick(*tables->reaching(margin * kicked.friction), kicked); };
    ProgramStability stability = leapfrog_stability(run, tables->longest_reach() / margin * (1.0 - 1e-12));
    stability.beside = [tables, margin, longest = stability.longest_decay](double stiffest) {
        const KickTable* table = tables->reaching(margin * std::min(stiffest, longest));
        return oscillation_limit_up_to([table](Kicked& kicked) { return explicit_kick(*table, kicked); }, std::min(stiffest, longest));
    };
    return stability;
}

ProgramStability backward_euler_leapfrog_stability() {
    ProgramStability stability = leapfrog_stability(backward_euler_kick, std::numeric_limits<double>::infinity());
    stability.beside = [](double stiffest) { return oscillation_limit_up_to(backward_euler_kick, stiffest); };
    return stability;
}

namespace {

/// Largest modulus of the eigenvalues of a step with this trace and determinant.
[[nodiscard]] double spectral_radius(double trace, double determinant) {
    const double discriminant = 0.25 * trace * trace - determinant;
    return discriminant < 0.0 ? std::sqrt(determinant) : 0.5 * std::abs(trace) + std::sqrt(discriminant);
}

}  // namespace

/// q ← q + v, v ← (v - ω² q)/(1 + c). Dampers take the velocity before the step: -1 is an eigenvalue at h δ = 2.
ProgramStability rigid_leapfrog_stability() {
    const auto radius = [](double x, double y) { return spectral_radius(1.0 + (1.0 - x * x) / (1.0 + y), 1.0 / (1.0 + y)); };
    constexpr double longest_damping = 2.0;
    ProgramStability stability{TestEquation::oscillator, radius, [](double decay) { return stage_figures(backward_euler_kick, decay); },
                               std::numeric_limits<double>::infinity(), longest_damping};
    stability.beside = [](double) { return FrictionLimit{2.0, 0.0}; };  // h²ω² = 4 + 2 h c
    return stability;
}

}  // namespace cvtflow::bench
