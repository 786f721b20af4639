#include "engine/method/composition.hpp"

#include <stdexcept>

namespace cvtflow::engine {

namespace {

/// Slots of one of the steps: its start and the slope there go to slots of their own, of which two take turns.
class Renaming {
public:
    Renaming(const StagePlan& plan, int step, int count)
        : start_(step == 0 ? 0 : plan.state_slots + (step - 1) % 2), slope_(step == 0 ? 0 : plan.slope_slots + (step - 1) % 2), share_(1.0 / count) {}

    [[nodiscard]] int state(int slot) const { return slot == 0 ? start_ : slot; }
    [[nodiscard]] int slope(int slot) const { return slot == 0 ? slope_ : slot; }
    [[nodiscard]] Combination operator()(const std::vector<Term>& states, const std::vector<Term>& slopes) const {
        Combination renamed;
        for (const Term& term : states) renamed.states.push_back({state(term.slot), term.factor});
        for (const Term& term : slopes) renamed.slopes.push_back({slope(term.slot), share_ * term.factor});
        return renamed;
    }

private:
    int start_, slope_;
    double share_;
};

}  // namespace

StagePlan repeated(const StagePlan& plan, int count) {
    if (count < 1) throw std::invalid_argument(plan.name + ": repeated " + std::to_string(count) + " times");
    StagePlan all{.name = plan.name + "-x" + std::to_string(count), .description = plan.description, .source = plan.source,
                  .state_slots = plan.state_slots + 2, .slope_slots = plan.slope_slots + 2, .stages = {}, .result = {}, .error = {}};
    Combination reached{{{0, 1.0}}, {}};
    for (int step = 0; step < count; ++step) {
        const Renaming names(plan, step, count);
        for (std::size_t k = 0; k < plan.stages.size(); ++k) {
            const Stage& stage = plan.stages[k];
            const Combination c = k == 0 ? reached : names(stage.states, stage.slopes);
            const int keep = k == 0 && step > 0 ? names.state(0) : stage.keep;
            all.stages.push_back({c.states, c.slopes, keep, names.slope(stage.slope)});
        }
        reached = names(plan.result.states, plan.result.slopes);
    }
    all.result = reached;
    return all;
}

}  // namespace cvtflow::engine
