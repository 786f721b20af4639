#pragma once
/// Finds the cheapest detail, method and step for a target accuracy of the outputs, by measuring.
///
/// Choices (levels of detail x methods x shares of the automatic step) are tried in the order of what they cost, at every operating point,
/// against a reference of the finest detail that passes a separate test. The first one whose errors, times a margin, stay within the target
/// everywhere is taken; nothing that ended early or whose energy balance does not close ever is.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tasks/tuning/dial.hpp"

namespace cvtflow::tasks {

/// Safety factor: errors at an untried point may be larger than at the tried points by this factor.
inline constexpr double tuning_margin = 2.0;
/// Margin where only one point is tried: it may happen to be one of small errors (measured: those within 5 % of it are 0.9 to 3.4 times).
inline constexpr double lone_point_margin = 4.0;
/// Largest difference of a reference to one with twice its step, as a share of the target over tuning_margin.
inline constexpr double reference_share = 0.25;

struct TuneSettings {
    double accuracy = 0.01;              ///< target error of every output
    std::vector<std::string> outputs{};  ///< figures or scalars; none: the usual figures
    std::vector<std::string> levels{};   ///< TuneChoice::detail of choices; none: all presets, and the scene's detail
    std::vector<std::string> methods{};  ///< METHOD or METHOD@STEP; none: those that "auto" chooses among
    double budget = 0.0;                 ///< wall time of the search, whatever it measures then; 0: no limit [s]
    /// Rank by work alone and by the default method, so that every machine and every run chooses the same.
    bool same_everywhere = false;
    bool all = false;  ///< measure every choice at every point, those too that are more expensive than the chosen one
    PointTimes times{};
    std::function<void(const std::string&)> progress;  ///< may be empty
};

struct TunedChoice {
    TuneChoice choice;
    double seconds = 0.0;        ///< processor time per simulated second, median of rounds in turns [s/s]
    double spread = 0.0;         ///< range of the rounds over their median, large on a busy machine
    double work = 0.0;           ///< PointCost::work, the largest of all points [1/s]
    bool tried = false;          ///< measured at one point at least
    std::vector<double> errors;  ///< largest error of every output at all points tried
    std::string worst;           ///< the point with the largest error
    std::string outcome;         ///< "chosen", "within the target", or why it is not taken
    bool front = false;          ///< no other that was tried is both cheaper and more exact
    double step = 0.0;           ///< fixed step, the shortest that the points need; 0: automatic [s]

    [[nodiscard]] double error() const noexcept { return largest(errors); }
};

struct TuneResult {
    std::string scene;
    double accuracy = 0.0;                ///< target [1]
    double margin = tuning_margin;        ///< factor on errors that the target has to allow
    std::vector<std::string> outputs;     ///< names
    std::vector<std::string> points;      ///< points at which choices were judged
    std::vector<std::string> references;  ///< origins of the references of those points
    std::vector<std::string> left_out;    ///< points and methods that were left out, with the reason
    std::vector<TunedChoice> choices;     ///< choices in the order of consideration
    std::optional<std::size_t> chosen;    ///< index of the chosen one
    std::string used_up_by;               ///< measurement that used up the budget; empty: none
    std::string next_digit;               ///< cost of a tenth of the target
    double wall = 0.0;                    ///< wall time of the search [s]

    [[nodiscard]] long tried() const noexcept;
    /// Reason why nothing was chosen: "no choice has errors times 4 within the target", or that the budget was used up, and by what.
    [[nodiscard]] std::string why_none() const;
};

/// Errors at a point that tuning did not use.
struct UnseenPoint {
    std::string name;
    std::vector<double> errors;  ///< error of every output; empty: no reference
    std::string remark;          ///< reason for a missing reference, or a fault of the run; may be empty
};

class Tuner {
public:
    /// A scene at points_of(). @throws SceneError for outputs that there are not
    Tuner(const Scene& scene, TuneSettings settings, const engine::Cancellation& cancel);
    /// A sweep at its corners, its scalars. @throws SceneError
    Tuner(const Sweep& sweep, TuneSettings settings, const engine::Cancellation& cancel);

    /// Reuses the measurements of earlier accuracies. A point's reference is measured when the first choice has run there.
    /// accuracy [1]
    /// @throws SimulationError: no point has a reference; interrupted
    [[nodiscard]] TuneResult tune(double accuracy);

    /// Errors of a choice at other points. accuracy [1]
    [[nodiscard]] std::vector<UnseenPoint> verify(const TunedChoice& choice, OperatingPoints points, double accuracy) const;

    /// DialSweep::settled_state() of a choice. step 0: automatic [s]
    [[nodiscard]] engine::SavedState settled_state(const TuneChoice& choice, double step) { return dial_.settled_state(choice, step); }
    [[nodiscard]] const OperatingPoints& points() const noexcept { return dial_.points(); }

private:
    Tuner(OperatingPoints points, TuneSettings settings, const engine::Cancellation& cancel);
    /// Every level with every method that can be used there.
    [[nodiscard]] std::vector<TunedChoice> find_bases();
    void find_costs();
    /// Every choice in turn, the cheapest first, until one is chosen or the budget is used up.
    void try_choices(TuneResult& result);
    /// Reference run of a point, measured when it is first needed; nullptr: the point has none and is left out.
    [[nodiscard]] const PointRun* reference_at(std::size_t point, TuneResult& result);
    [[nodiscard]] bool worth_trying(const TunedChoice& candidate, const TuneResult& result) const;
    void try_at_points(TunedChoice& candidate, TuneResult& result);
    [[nodiscard]] const PointRun& run_at(const TunedChoice& candidate, std::size_t point);
    [[nodiscard]] std::string next_digit(const TuneResult& result) const;
    /// Wall time of a run at a point, by the costs measured [s]. @param cost [s/s]
    [[nodiscard]] double expected(double cost) const noexcept;
    /// Reports the present measurement. @param seconds its expected duration, 0: unknown [s]
    void say(const std::string& what, double seconds = 0.0);

    TuneSettings settings_;
    const engine::Cancellation& cancel_;
    DialSweep dial_;
    std::vector<std::string> left_out_;
    std::vector<TunedChoice> ranked_;                               ///< cheapest first
    std::map<std::pair<std::string, std::size_t>, PointRun> runs_;  ///< runs by choice and point
    std::map<std::size_t, bool> judged_;  ///< points at which a choice has run for the present accuracy: whether they have a reference
    std::string measuring_;               ///< last measurement that say() reported
};

}  // namespace cvtflow::tasks
