#pragma once
/// The nonlinear friction solve in the task graph: Newton's method with a line search on the convex energy of slips
/// (model/contact/slip/slip_space.hpp), by groups of links.
///
///     iterate   eliminate[group] ─► join ─► substitute[group] ─► search[group]   one whole Newton step, and what it is worth
///     search    search[group]                                                   a share of it
///
/// Where saturation speeds are so low that this does not get there (the energy is almost one with kinks), they are taken ten times as high,
/// a hundred times and so on, until it does; from there they are brought back in strides, each solution being the start of the next solve.
/// Groups belong to the chain, not to segments or threads: the same bits for every schedule. A solve that does not converge goes on with
/// the best it has and is counted.

#include <string>
#include <vector>

#include "model/contact/slip/slip_space.hpp"
#include "tasks/step/step_graph.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// What happened so far. All monotone.
struct SolveStatistics {
    long solves = 0;
    long iterations = 0;
    long most = 0;       ///< iterations of the worst solve
    long searches = 0;   ///< shares of steps that were tried
    long continued = 0;  ///< solves that got there by way of higher saturation speeds
    long unconverged = 0;
    double worst = 0.0;  ///< largest accepted residual [m/s]
};

/// One line: "1.02 iterations per solve (most 7), …".
[[nodiscard]] std::string text(const SolveStatistics& statistics);

class FrictionSolve {
public:
    /// A contact's force may be off by what changes its slip by this much in one step of `usual_step` or more [m/s]. Errors of all methods
    /// at 2 µs are the same with a hundredth of it.
    static constexpr double usual_tolerance = 1e-5, min_tolerance = 1e-9;
    static constexpr double usual_step = 2e-6;  ///< [s]
    static constexpr int max_iterations = 2000;
    /// In shorter steps by less: the error of a method falls with its step. step [s]
    [[nodiscard]] static double tolerance(double step) noexcept;

    explicit FrictionSolve(const Workspace& workspace);

    [[nodiscard]] int groups() const noexcept { return static_cast<int>(groups_.size()); }
    [[nodiscard]] model::SlipGroup& group(int number) noexcept { return groups_[static_cast<std::size_t>(number)]; }
    [[nodiscard]] const model::SlipSpace& space() const noexcept { return space_; }
    [[nodiscard]] const model::SlipStretches& stretches() const noexcept { return joints_.stretches; }

    /// Begins a solve from group.predicted (this link's part of ŵ) and group.slip (where to start): the first cycle to run. @param step h
    /// [s]
    [[nodiscard]] NextCycle begin(double step) noexcept;
    /// After each of its cycles: the next one, or done, or failed where forces are no numbers.
    [[nodiscard]] NextCycle next() noexcept;
    [[nodiscard]] const SolveStatistics& statistics() const noexcept { return statistics_; }

    // Bodies of tasks.
    void eliminate(int group) noexcept;
    void join() noexcept { space_.join(groups_, joints_); }
    void substitute(int group) noexcept;
    void search(int group) noexcept;
    /// Takes the share of the Newton step that was settled on; to be called for every group in the cycle after the solve.
    void settle(int group) noexcept;
    /// Slips of a group's contacts from the `own` parts, or others like them, of the group and its neighbours.
    void assemble(int group, model::LaneRows& slips, model::LaneRows model::SlipGroup::*parts = &model::SlipGroup::own) noexcept;

private:
    [[nodiscard]] NextCycle judge() noexcept;
    [[nodiscard]] NextCycle accept() noexcept;
    [[nodiscard]] NextCycle finish(bool converged) noexcept;
    [[nodiscard]] NextCycle lower_speeds() noexcept;
    [[nodiscard]] NextCycle raise_speeds() noexcept;
    void keep_forces(int group) noexcept;
    void change_speeds(int group) noexcept;

    model::SlipSpace space_;
    std::vector<model::SlipGroup> groups_;
    model::SlipChain joints_;
    SolveStatistics statistics_;
    double tolerance_ = min_tolerance;  ///< [m/s]
    int iterations_ = 0, searches_ = 0;
    int tries_ = 0;                         ///< iterations with the saturation speeds at hand
    double continuation_ = 1.0;             ///< of the saturation speeds [1]
    double continuation_before_ = 1.0;      ///< that slips belong to [1]
    double solved_ = 0.0;                   ///< lowest continuation that has been solved with, 0: none yet [1]
    double stride_ = 1.0;                   ///< from there to the next [1]
    int patience_ = 0;                      ///< iterations after which saturation speeds are changed
    bool keeps_ = false, returns_ = false;  ///< the iteration that begins follows a solution, or goes back to it
    bool searching_ = false;
    bool steps_ = false;                                                  ///< a Newton step has not been settled yet
    double fraction_ = 1.0;                                               ///< fraction of the Newton step that is tried
    double settled_ = 1.0;                                                ///< of the last one, that was taken [1]
    double low_ = 0.0, high_ = 1.0, slope_low_ = 0.0, slope_high_ = 0.0;  ///< bracket of the search
    double residual_ = 0.0;                                               ///< [m/s]
};

/// Cycles of methods that solve for friction.
enum SolveCycle : int { record_cycle = method_cycles, gather_cycle, iterate_cycle, search_cycle, stage_cycle, finish_cycle };

/// What these methods share: contacts that are recorded by segments, gathered by groups and solved.
class FrictionImplicit : public StepMethod {
public:
    explicit FrictionImplicit(Workspace& workspace);

    void add_tasks(engine::TaskGraph& graph) override;
    [[nodiscard]] bool retakes() const noexcept override { return true; }
    void transition() noexcept override {}
    [[nodiscard]] Fault fault() const noexcept override { return {FaultKind::non_finite, w_.step.time, {}, 0.0, 0.0}; }
    [[nodiscard]] std::string report() const override { return text(solve_.statistics()); }

    // Bodies of tasks.
    virtual void record(int segment) noexcept = 0;
    virtual void gather(int group) noexcept = 0;
    virtual void base(int group) noexcept = 0;
    virtual void stage(int group) noexcept = 0;
    virtual void finish(int group) noexcept = 0;
    [[nodiscard]] FrictionSolve& solve() noexcept { return solve_; }

protected:
    /// Notes the contacts of a segment's links. @param window states of links first - 1 … last
    void record_window(int segment, const double* window, const model::ContactDrift& drift) noexcept;
    /// Numbers of a state or slope vector from `offset` in each link's block on, lane by lane.
    void read(const double* vector, int offset, int group, model::LaneRows& rows) noexcept;

    Workspace& w_;
    FrictionSolve solve_;
    model::ContactField field_;
    model::Columns frictionless_;                ///< accelerations by all but friction; column = link + 1
    std::vector<model::LinkLoad> normal_loads_;  ///< [links]

private:
    void add_recording(engine::TaskGraph& graph);
    void add_neighbours(engine::TaskGraph& graph, const std::vector<int>& gathers, const std::vector<int>& substitutes);
};

}  // namespace cvtflow::tasks
