#pragma once
/// A sweep over the dial: choices of detail, method and step, each run as a case of a sweep whose cases are operating points; outputs of a
/// case are compared with those of the reference case.

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/executor/cancellation.hpp"
#include "tasks/batch/start_states.hpp"

namespace cvtflow::tasks {

/// A choice for a scene.
struct TuneChoice {
    std::string detail;  ///< name of a preset, and settings "key=value" after it; empty: detail of the scene
    std::string method;
    double share = 1.0;  ///< share of the automatic step; 1: automatic steps
    double step = 0.0;   ///< fixed step whatever the automatic one is; 0: none [s]

    /// "fine, leapfrog-sweep, 1/2 of the automatic step"
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

/// A named output: a scalar of sweeps with a scale of its errors.
struct Figure {
    std::string_view name, scalar, meaning;
    bool usual;                                  ///< part of the default outputs
    double (*scale)(double expected) = nullptr;  ///< an error is |is - expected| over that; nullptr: over |expected|
};
[[nodiscard]] std::span<const Figure> figures() noexcept;

struct TunedOutput {
    std::string name;
    Scalar scalar;
    double (*scale)(double expected) = nullptr;

    [[nodiscard]] double error(double is, double expected) const noexcept;  ///< relative [1]. is, expected [unit of the output]
};

/// Outputs by their names; none: the usual figures that the machine has.
/// @throws SceneError for a name that is neither figure nor scalar, or a figure of pulleys in a scene without pulleys
[[nodiscard]] std::vector<TunedOutput> tuned_outputs(const std::vector<std::string>& names, bool has_pulleys);

/// Durations of a run at a point: a change of detail excites vibrations, which decay before outputs count.
struct PointTimes {
    double settle = 20e-3;   ///< [s]
    double average = 16e-3;  ///< [s]
};

/// Operating points, where a choice has to be right: cases of a sweep without a choice, whose scalars are the outputs.
struct OperatingPoints {
    Sweep sweep;
    std::vector<TunedOutput> outputs;
    std::vector<long> cases;
    std::vector<std::string> names;  ///< "start", "load.torque = 230 N*m", "case 17" [cases]
};

/// A scene with its inputs as they are at t = 0, then each table over time at its lowest and highest value, the others as at t = 0.
/// @throws SceneError for a scene whose inputs cannot be held
[[nodiscard]] OperatingPoints points_of(const Scene& scene, const PointTimes& times, const std::vector<TunedOutput>& outputs);
/// Points that lie between those: every table over time somewhere between its lowest and highest value; load and clamping, where they
/// are constant, within 5 % of what they are; of a ring the speed. Equal seeds give equal points.
[[nodiscard]] OperatingPoints unseen_points(const Scene& scene, const PointTimes& times, const std::vector<TunedOutput>& outputs,
                                            std::size_t count, std::uint64_t seed);
/// Cases of a sweep with its scalars.
[[nodiscard]] OperatingPoints points_of(const Sweep& sweep, const std::vector<long>& cases);
/// Cases at the corners of a sweep's axes: all combinations of the rows in which a key is lowest, highest, first or last. If there are more
/// than `most`, that number is picked evenly, first and last included. Cases whose values contradict each other are left out.
[[nodiscard]] std::vector<long> corner_cases(const Sweep& sweep, std::size_t most = 8);

/// Thrown where the budget ends during a measurement. No std::exception: it is no objection to what is measured.
struct BudgetUsedUp {};

/// A run of a choice at a point.
struct PointRun {
    std::vector<double> values;  ///< values of the outputs
    std::string objection;       ///< reason why `values` are invalid: a fault, or an energy balance that does not close; empty: valid
    bool unsteady = false;       ///< means that counted still change
};

/// Cost of a choice.
struct PointCost {
    double seconds = 0.0;  ///< processor time per simulated second [s/s]
    double work = 0.0;     ///< evaluations times unknowns per simulated second: the same on every machine [1/s]
};

class DialSweep {
public:
    /// @param cancel must outlive it
    DialSweep(OperatingPoints points, const engine::Cancellation& cancel);

    [[nodiscard]] const OperatingPoints& points() const noexcept { return points_; }
    [[nodiscard]] std::size_t size() const noexcept { return points_.cases.size(); }
    /// Limits the wall time of all that follows. seconds [s], 0: no limit
    void begin_budget(double seconds) noexcept;
    /// Time that is left of it, always above zero; 0: no limit [s].
    [[nodiscard]] double left() const noexcept;

    /// All measurements. @throws SimulationError, SceneError, engine::RecordError: no run can begin here; interrupted; BudgetUsedUp
    /// @param step fixed, 0: automatic [s]
    [[nodiscard]] PointRun run(const TuneChoice& choice, double step, std::size_t point);
    /// The step that a choice means at all points: the shortest of theirs [s]. 0: automatic
    [[nodiscard]] double step_of(const TuneChoice& choice);
    /// Cost of some steps from the start of a point, with its automatic step or the choice's fixed one.
    [[nodiscard]] PointCost cost(const TuneChoice& choice, std::size_t point);
    /// The state with which outputs begin to count at the first point: settled at its detail, at t = 0.
    [[nodiscard]] engine::SavedState settled_state(const TuneChoice& choice, double step);

    /// Reference outputs: the finest detail with the default method at a quarter of its automatic step, or less, so that twice that
    /// step has errors of at most `agreement`. Computed on first use, or for a smaller `agreement`.
    struct Reference {
        std::map<double, PointRun> runs;  ///< runs by share of the automatic step
        const PointRun* run = nullptr;    ///< nullptr: none; `text` states why
        double share = 0.0;               ///< share of its automatic step
        double agreement = 0.0;           ///< difference to twice its step [1]
        std::string text;                 ///< origin, and the difference to one with twice its step
    };
    /// @param before called before each of its runs with the share of the automatic step; may be empty
    const Reference& reference(std::size_t point, double agreement, const std::function<void(double)>& before = {});
    [[nodiscard]] const Reference& reference(std::size_t point) const { return references_[point]; }
    /// Relative error of every output; infinite where the run has none.
    [[nodiscard]] std::vector<double> errors(const PointRun& run, const PointRun& expected) const;

private:
    [[nodiscard]] Scene scene_at(const TuneChoice& choice, double step, std::size_t point) const;
    [[nodiscard]] StartStates::State start_of(const Scene& chosen, std::size_t point) const;
    [[nodiscard]] std::unique_ptr<Simulation> begin(const TuneChoice& choice, double step, std::size_t point) const;
    [[nodiscard]] Fault advance(Simulation& simulation, Goal goal) const;
    void refine(std::size_t point, double agreement, const std::function<void(double)>& before);

    OperatingPoints points_;
    const engine::Cancellation& cancel_;
    std::vector<Reference> references_;  ///< [cases]
    bool limited_ = false;
    std::chrono::steady_clock::time_point end_{};
};

/// Largest of all; 0 for none.
[[nodiscard]] double largest(const std::vector<double>& errors) noexcept;

}  // namespace cvtflow::tasks
