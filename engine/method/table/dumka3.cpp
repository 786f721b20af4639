/// DUMKA3 as plans: s - 3 chained Euler steps, then a finish of two stages that carries the complex pair of roots, then one Euler step.
/// Two state slots and two slope slots take turns along the chain, whatever the degree; the finish needs two slopes more.
/// Source: Medovikov, BIT 38 (1998) 372-390; error estimate as in his program: h (c3/2 (f1 - f3) + (c4 - c2)/2 (f2 - f0)) of the finish.

#include <string>

#include "engine/method/stage_plan.hpp"
#include "engine/method/table/dumka3_coefficients.hpp"

namespace cvtflow::engine {

namespace {

/// Present position in the chain of Euler steps.
struct Front {
    int state = 0;
    int slope = 0;
};

/// Of two slots 1 and 2 the one that is not in use.
int other(int slot) { return slot == 1 ? 2 : 1; }

Front euler_step(StagePlan& plan, Front from, double length) {
    const Front to{other(from.state), other(from.slope)};
    plan.stages.push_back({{{from.state, 1.0}}, {{from.slope, length}}, to.state, to.slope});
    return to;
}

/// The last stage is evaluated at the result: its slope is the next step's first.
void finish(StagePlan& plan, Front from, const Dumka3Finish& a) {
    const int f0 = from.slope, f1 = 3, f2 = other(f0), f3 = 4;
    const int g3 = other(from.state), end = other(g3);
    plan.stages.push_back({{{from.state, 1.0}}, {{f0, a.a21}}, -1, f1});
    plan.stages.push_back({{{from.state, 1.0}}, {{f0, a.a31}, {f1, a.a32}}, g3, f2});
    plan.stages.push_back({{{g3, 1.0}}, {{f2, a.a43}}, end, f3});
    plan.result = {{{end, 1.0}}, {}};
    const double c3 = a.a31 + a.a32, c4 = c3 + a.a43;
    const double early = 0.5 * c3, late = 0.5 * (c4 - a.a21);
    plan.error = Combination{{}, {{f0, -late}, {f1, early}, {f2, late}, {f3, -early}}};
}

}  // namespace

StagePlan dumka3(int polynomial) {
    const Dumka3Coefficients table = dumka3_coefficients(polynomial);
    const auto degree = 3 * (table.blocks.size() + 1);
    StagePlan plan{"dumka3-p" + std::to_string(polynomial),
                   "DUMKA3 of degree " + std::to_string(degree) + ": stabilised, for mildly stiff problems",
                   "Medovikov, BIT 38 (1998) 372-390",
                   3,
                   5,
                   {{{{0, 1.0}}, {}, -1, 0}},
                   {},
                   {}};
    Front front;
    for (const auto& block : table.blocks) {
        for (const double length : block) front = euler_step(plan, front, length);
    }
    finish(plan, front, table.finish);
    return plan;
}

}  // namespace cvtflow::engine
