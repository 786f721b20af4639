#pragma once
/// Observation of a running integration by its caller: outputs, transitions, counters.

#include <string_view>

#include "model/law/phase_rule.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Counters so far. All monotone.
struct Counters {
    long steps = 0;        ///< accepted steps, truncated ones included
    long evaluations = 0;  ///< evaluations of the right-hand side
    long detected = 0;     ///< transitions carried out
    long truncated = 0;    ///< steps cut at a transition
    long suppressed = 0;   ///< transitions postponed because the tip had just changed
    long rejected = 0;     ///< steps taken again because of their error
    bool operator==(const Counters&) const = default;
};

/// The only list of the counters: calls visitor(name, count) for each. `counters` are Counters or const ones.
template <class AnyCounters, class Visitor>
void visit_counters(AnyCounters& counters, Visitor& visitor) {
    visitor("steps", counters.steps), visitor("evaluations", counters.evaluations), visitor("detected", counters.detected);
    visitor("truncated", counters.truncated), visitor("suppressed", counters.suppressed), visitor("rejected", counters.rejected);
}

/// One change of a tip's phase, as recorded.
struct TransitionRecord {
    double time;  ///< [s]
    int pin;      ///< link's rear pin + end
    int tip;      ///< 4 link + 2 end + side
    model::Phase from, to;
};

/// Called by the controller, serially, while the graph rests. May throw: the run then ends and the exception reaches its caller.
class RunObserver {
public:
    virtual ~RunObserver() = default;
    /// Called at every output time, the first one included. The workspace's slot 0 has the state.
    virtual void output(double time, const Workspace& workspace, const Counters& counters) = 0;
    /// Whether sample() should be called now if the next occasion is at `time`. Asked where a step has ended and no output is due. Changes
    /// no result. time [s]
    [[nodiscard]] virtual bool samples(double time) const noexcept {
        (void)time;
        return false;
    }
    /// Called between two outputs, where samples() requests it. The workspace's slot 0 has the state. time [s]
    virtual void sample(double /*time*/, const Workspace& /*workspace*/, const Counters& /*counters*/) {}
    /// Called after each truncated step, for every tip that changed.
    virtual void transition(const TransitionRecord& record) = 0;

protected:
    RunObserver() = default;
    RunObserver(const RunObserver&) = default;
    RunObserver& operator=(const RunObserver&) = default;
};

/// Ignores everything.
class SilentObserver final : public RunObserver {
public:
    void output(double, const Workspace&, const Counters&) override {}
    void transition(const TransitionRecord&) override {}
};

}  // namespace cvtflow::tasks
