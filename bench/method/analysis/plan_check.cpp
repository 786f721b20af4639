#include "bench/method/analysis/plan_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/method/product_names.hpp"

namespace cvtflow::bench {

namespace {

/// Walks through a plan in order of execution and remembers which slots hold something.
class Validator {
public:
    explicit Validator(const StagePlan& plan)
        : plan_(plan),
          states_(static_cast<std::size_t>(std::max(plan.state_slots, 1)), false),
          slopes_(static_cast<std::size_t>(std::max(plan.slope_slots, 1)), false) {
        states_[0] = true;
    }

    void run() {
        where_ = "plan";
        if (plan_.state_slots < 1 || plan_.slope_slots < 1) fail("needs at least one state slot and one slope slot");
        if (plan_.stages.empty()) fail("has no stage");
        for (std::size_t i = 0; i < plan_.stages.size(); ++i) {
            where_ = "stage " + std::to_string(i);
            if (i == 0) first_stage(plan_.stages[0]);
            stage(plan_.stages[i], i == 0);
        }
        where_ = "result";
        reads(plan_.result.states, plan_.result.slopes, 1.0);
        where_ = "error estimate";
        if (plan_.error) reads(plan_.error->states, plan_.error->slopes, 0.0);
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw std::invalid_argument(plan_.name + ": " + where_ + ": " + what); }

    void first_stage(const Stage& stage) const {
        if (stage != Stage{{{0, 1.0}}, {}, -1, 0}) fail("must be f(t, y): states {{0, 1}}, no slopes, nothing kept, slope slot 0");
    }

    void stage(const Stage& stage, bool first) {
        reads(stage.states, stage.slopes, 1.0);
        if (!first && stage.slope == 0) fail("writes slope slot 0, which holds f(t, y) for the whole step");
        if (stage.keep == 0) fail("writes state slot 0, which holds y for the whole step");
        writes(states_, stage.keep, stage.states, "state", true);
        writes(slopes_, stage.slope, stage.slopes, "slope", false);
    }

    void reads(const std::vector<Term>& states, const std::vector<Term>& slopes, double expected) const {
        check_written(states_, states, "state");
        check_written(slopes_, slopes, "slope");
        double sum = 0.0;
        for (const Term& term : states) sum += term.factor;
        if (!(std::abs(sum - expected) <= 1e-12)) fail(fmt::format("state factors sum to {:.6f} instead of {:.6f}", sum, expected));
    }

    void check_written(const std::vector<bool>& written, const std::vector<Term>& terms, const std::string& kind) const {
        for (const Term& term : terms) {
            check_range(written, term.slot, kind);
            if (!std::isfinite(term.factor)) fail("factor of " + kind + " slot " + std::to_string(term.slot) + " is not finite");
            if (!written[static_cast<std::size_t>(term.slot)])
                fail("reads " + kind + " slot " + std::to_string(term.slot) + " before it is written");
        }
    }

    void check_range(const std::vector<bool>& written, int slot, const std::string& kind) const {
        if (slot >= 0 && static_cast<std::size_t>(slot) < written.size()) return;
        fail(kind + " slot " + std::to_string(slot) + " is outside 0…" + std::to_string(written.size() - 1));
    }

    void writes(std::vector<bool>& written, int slot, const std::vector<Term>& read, const std::string& kind, bool optional) const {
        if (optional && slot == -1) return;
        check_range(written, slot, kind);
        const bool also_read = std::any_of(read.begin(), read.end(), [&](const Term& term) { return term.slot == slot; });
        if (also_read) fail("writes " + kind + " slot " + std::to_string(slot) + " and reads it: neighbouring segments would race");
        written[static_cast<std::size_t>(slot)] = true;
    }

    const StagePlan& plan_;
    std::vector<bool> states_;
    std::vector<bool> slopes_;
    std::string where_;
};

}  // namespace

void validate(const StagePlan& plan) { Validator(plan).run(); }

}  // namespace cvtflow::bench
