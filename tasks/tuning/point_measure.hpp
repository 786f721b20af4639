#pragma once
/// Operating points, where a choice of detail, method and step has to be right (a scene as it begins, the extremes of its tables over time,
/// corners of a sweep, points in between): what a choice gives there, what that costs, and what it should be.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/executor/cancellation.hpp"
#include "engine/record/run/state_file.hpp"
#include "tasks/batch/sweep/sweep.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/scene.hpp"
#include "tasks/tuning/output.hpp"

namespace cvtflow::tasks {

struct OperatingPoint {
    std::string name;                ///< "start", "load.torque = 230", "case 17"
    Scene scene;                     ///< scene with the inputs of the point; no choice applied
    double from = 0.0, until = 0.0;  ///< outputs count from there to there [s]
    bool settles = false;            ///< every choice settles from a geometric start; else all begin with the same state
};

/// Durations of a run at a point: a change of detail excites vibrations, which decay before outputs count.
struct PointTimes {
    double settle = 20e-3;   ///< [s]
    double average = 16e-3;  ///< [s]
};

/// The scene with its inputs as they are at t = 0, then each table over time at its lowest and highest value, the others as at t = 0.
[[nodiscard]] std::vector<OperatingPoint> points_of(const Scene& scene, const PointTimes& times);

/// Points that lie between those: every table over time somewhere between its lowest and highest value; load and clamping, where they
/// are constant, within 5 % of what they are; of a ring the speed. Equal seeds give equal points.
[[nodiscard]] std::vector<OperatingPoint> unseen_points(const Scene& scene, const PointTimes& times, int count, std::uint64_t seed);

/// A case of a sweep, as it is run there.
[[nodiscard]] OperatingPoint point_of_case(const Sweep& sweep, long number);

/// Cases at the corners of a sweep's axes: all combinations of the rows in which a key is lowest, highest, first or last. If there are more
/// than `most`, that number is picked evenly, first and last included. Cases whose values contradict each other are left out.
[[nodiscard]] std::vector<long> corner_cases(const Sweep& sweep, std::size_t most = 8);

/// A choice for a scene.
struct TuneChoice {
    std::string detail;  ///< name of a preset; empty: detail of the scene
    std::string method;
    double share = 1.0;  ///< share of the automatic step; 1: automatic steps

    /// "fine, leapfrog-chebyshev, 1/2 of the automatic step"
    [[nodiscard]] std::string text() const;
    bool operator==(const TuneChoice&) const = default;
};

/// The scene with a choice applied. @param step fixed, 0: automatic [s]   @throws SceneError
[[nodiscard]] Scene chosen_scene(const Scene& scene, const TuneChoice& choice, double step);

/// A settled state brought over to another level of detail. Coordinates that both have are copied, new ones begin at zero: Legendre
/// coordinates of higher order, elastic displacements of sheaves. Rigid pulleys take angles from the shafts and the movable sheaves'
/// positions against their shafts, and give them back. Phases stay. A rigid pin is put in the middle between its two halves, and its halves
/// where they roll on each other. Control and ledger are left out: they begin at zero.
[[nodiscard]] engine::SavedState convert_state(const engine::SavedState& saved, const model::Parameters& from, const model::Parameters& to);

/// Time limit of measurements.
class Deadline {
public:
    /// Begins a budget. seconds [s], 0: no limit
    void begin(double seconds) noexcept {
        limited_ = seconds > 0.0;
        end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, 1e9)));
    }
    void clear() noexcept { limited_ = false; }
    /// Time left for Goal::max_wall, always above zero; 0: no limit [s].
    [[nodiscard]] double left() const noexcept {
        return limited_ ? std::max(1e-9, std::chrono::duration<double>(end_ - Clock::now()).count()) : 0.0;
    }
    [[nodiscard]] bool passed() const noexcept { return limited_ && Clock::now() >= end_; }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point end_{};
    bool limited_ = false;
};

inline const Deadline no_deadline;

/// Thrown where the deadline has passed during a measurement. No std::exception: it is no objection to what is measured.
struct BudgetUsedUp {};

/// A run of a choice at a point.
struct PointRun {
    std::vector<double> values;  ///< values of the outputs
    std::string objection;       ///< reason why `values` are invalid: a fault, or an energy balance that does not close; empty: valid
    double step = 0.0;           ///< fixed one; 0: automatic [s]
    double seconds = 0.0;        ///< processor time per simulated second [s/s]
    double work = 0.0;       ///< evaluations of the right-hand side times unknowns, per simulated second: the same on every machine [1/s]
    std::uint64_t hash = 0;  ///< hash of the state at the end of a trial
    bool unsteady = false;   ///< means that counted still change
};

class PointMeasure {
public:
    /// @param finest preset that references have   @param outputs, cancel, deadline must outlive it
    PointMeasure(OperatingPoint point, std::string finest, std::span<const TunedOutput> outputs, const engine::Cancellation& cancel,
                 const Deadline& deadline = no_deadline);
    PointMeasure(const PointMeasure&) = delete;
    PointMeasure& operator=(const PointMeasure&) = delete;

    /// All measurements. @throws SimulationError, engine::RecordError: no run can begin here; BudgetUsedUp
    /// @param state  if given, that at the start of the averages; unchanged if the run ended before
    [[nodiscard]] PointRun run(const TuneChoice& choice, engine::SavedState* state = nullptr);
    /// A short run from the start, to measure its cost. duration [s]
    [[nodiscard]] PointRun trial(const TuneChoice& choice, double duration);

    /// Reference outputs: the finest detail with the default method at a quarter of its automatic step, or less, so that twice that
    /// step has errors of at most `agreement`. Computed on first use, or for a smaller `agreement`.
    /// @param before called before each of its runs with the share of the automatic step; may be empty
    /// @return empty: no reference; objection() states why
    [[nodiscard]] const PointRun* reference(double agreement, const std::function<void(double)>& before = {});
    [[nodiscard]] const std::string& objection() const noexcept { return objection_; }
    /// Origin of the reference, and its difference to one with twice its step.
    [[nodiscard]] const std::string& reference_text() const noexcept { return reference_text_; }

    /// Relative error of every output; infinite where the run has none.
    [[nodiscard]] std::vector<double> errors(const PointRun& run, const PointRun& expected) const;
    [[nodiscard]] const OperatingPoint& point() const noexcept { return point_; }

private:
    /// Simulation::advance() up to the deadline. @throws BudgetUsedUp
    [[nodiscard]] Fault advance(Simulation& simulation, Goal goal, RunObserver& observer);
    [[nodiscard]] engine::SavedState start(const Scene& scene);
    [[nodiscard]] std::unique_ptr<Simulation> begin(const TuneChoice& choice, Scene& scene, bool settled, PointRun& run);
    void settle_finest();

    OperatingPoint point_;
    std::string finest_;
    std::span<const TunedOutput> outputs_;
    const engine::Cancellation& cancel_;
    const Deadline& deadline_;
    std::optional<engine::SavedState> settled_;  ///< start state of the scene, or one settled at the finest detail
    Scene settled_with_;                         ///< scene of `settled_`
    std::map<double, PointRun> references_;      ///< references by share of the automatic step
    double agreement_ = 0.0;                     ///< largest difference of `reference_` to one with twice its step
    const PointRun* reference_ = nullptr;
    std::string objection_, reference_text_;
};

/// Largest of all; 0 for none.
[[nodiscard]] double largest(const std::vector<double>& errors) noexcept;

}  // namespace cvtflow::tasks
