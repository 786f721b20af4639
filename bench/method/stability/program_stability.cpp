#include "bench/method/stability/program_stability.hpp"

#include <algorithm>
#include <limits>

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

}  // namespace cvtflow::bench
