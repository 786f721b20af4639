#pragma once
/// The part of the leapfrog of pin halves outside friction.
///
///     q ← q + h/2 v;   velocities extrapolated to the middle, where contacts and all other forces are taken;   …;   q ← q + h/2 v
///
/// and data of the step before: its mean acceleration, the motion of the sheaves in its middle, its length; and the cycles of
/// tasks in which friction is solved for.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

class LeapfrogFrame {
public:
    /// Slots of the workspace that it uses.
    static constexpr int state_slots = 2, slope_slots = 3;

    explicit LeapfrogFrame(Workspace& workspace) : w_(workspace) {}

    /// Forgets the previous step.
    void restart() noexcept;
    /// Whether there is a step before the one that begins.
    [[nodiscard]] bool continues() const noexcept { return continues_; }
    /// Data of the step before become history; workspace.step.row for the middle of the step, and the sheaves there.
    void begin();
    /// Pulleys, from what the chain does to them; workspace.step.row for the result, whose links are in state slot 1.
    void end(const model::SheaveForces& chain);

    [[nodiscard]] const model::ContactDrift& drift() const noexcept { return drift_; }

    void save(std::vector<double>& memory) const;
    /// @param memory from save()   @return the rest of the memory
    [[nodiscard]] std::span<const double> load(std::span<const double> memory);

private:
    void extrapolate();

    Workspace& w_;
    bool continues_ = false;  ///< whether a step precedes the present one
    double length_ = 0.0;     ///< length of the present step [s]
    alignas(model::cache_line) model::ContactDrift drift_;
    model::SheaveMotion sheaves_before_[4]{};
};

/// Cycles of the graph that take several rounds of friction (stages, passes) one after the other. A segment's round waits for its previous
/// one and for those of the segments whose velocities it reads. Its output has two places in turn, so that a round does not overwrite what
/// its neighbours read.
class PassCycles {
public:
    static constexpr int count = 4;

    /// @param first number of the first cycle   @param rounds of each, ascending from 1
    constexpr PassCycles(int first, std::array<int, count> rounds) noexcept : first_(first), rounds_(rounds) {}

    /// Adds the tasks of all cycles: item = round of the cycle × segments + segment. @param noun of a round   @param more adds accesses
    void add_tasks(engine::TaskGraph& graph, const Workspace& workspace, const char* noun, engine::TaskCode code,
                   const std::function<void(LinkAccesses&)>& more) const;

private:
    friend class Rounds;

    int first_;
    std::array<int, count> rounds_;
};

/// The rounds of a step, taken by cycles.
class Rounds {
public:
    Rounds() = default;
    Rounds(const PassCycles& cycles, int count) noexcept : cycles_(&cycles), count_(count) {}

    [[nodiscard]] int count() const noexcept { return count_; }
    /// Whether some are in no cycle yet.
    [[nodiscard]] bool left() const noexcept { return next_ < count_; }
    /// Takes the longest cycle that the remaining ones fill. @return its number
    [[nodiscard]] int next() noexcept;
    /// The first round of the present cycle.
    [[nodiscard]] int begun() const noexcept { return begun_; }

private:
    const PassCycles* cycles_ = nullptr;
    int count_ = 0, begun_ = 0, next_ = 0;
};

/// Accesses of the task that records a segment's contacts and all other forces.
[[nodiscard]] LinkAccesses record_accesses(const Workspace& workspace, int segment);

}  // namespace cvtflow::tasks
