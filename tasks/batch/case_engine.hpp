#pragma once
/// One thread's engine: runs one case after the other in the same memory. Internal to tasks/batch.

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>

#include "engine/executor/tbb/job_pool.hpp"
#include "tasks/batch/strand_ends.hpp"
#include "tasks/run/run_loop.hpp"

namespace cvtflow::tasks {

/// End of a case; the column `status` has these names.
enum class CaseStatus { ok, unreliable, diverged, budget, bad_parameters, crashed, undefined, stopped, not_steady, cycle_missed };
/// Contents of a row.
[[nodiscard]] std::span<const std::string_view> status_names() noexcept;
[[nodiscard]] std::string_view status_name(CaseStatus status) noexcept;
/// Whether a case has run completely, so that its scalars are what its status calls them.
[[nodiscard]] constexpr bool has_scalars(CaseStatus status) noexcept {
    return status == CaseStatus::ok || status == CaseStatus::not_steady || status == CaseStatus::cycle_missed;
}

struct CaseResult {
    long number = -1;
    CaseStatus status = CaseStatus::ok;
    std::string error;
    std::string_view start;
    std::uint64_t start_state = 0;  ///< content_hash() of the state that it began with; 0: none
    std::vector<double> scalars;    ///< NaN unless has_scalars(status) [scalars of the sweep]
    std::vector<double> errors;     ///< relative errors of scalars where cases end when they are steady; NaN: none [scalars of the sweep]
    double settled_for = 0.0;       ///< begin of the means where cases end when they are steady; NaN: none [s]
    Counters counters, settling;
    double wall = 0.0;                 ///< settling included [s]
    std::uint64_t hash = 0;            ///< hash of the final state
    double efficiency = 0.0;           ///< 1 - losses/input over whole pin periods since sweep.from [1]
    double residual = 0.0;             ///< residual of the energy balance over the losses, without settling
    double balance_error_ratio = 0.0;  ///< larger one of settling and run; above 1 unreliable
    std::string notes;                 ///< names of notes on unusual results, separated by blanks
};

/// State that all threads of a process share: when to stop.
class BatchControl {
public:
    using Notice = std::function<void(const std::string&)>;
    /// @param grace time [s]   @param notice  receives warnings, from one thread at a time; may be empty
    BatchControl(double grace, const engine::Cancellation& stop, Notice notice = {})
        : grace_(grace), stop_(stop), notice_(std::move(notice)) {}

    [[nodiscard]] const engine::Cancellation& stop() const noexcept { return stop_; }
    /// Seconds left of the grace time, which begins with the first call after the request to stop.
    [[nodiscard]] double grace_left();
    void tell(const std::string& what);

private:
    double grace_;  ///< [s]
    const engine::Cancellation& stop_;
    Notice notice_;
    engine::Mutex mutex_;
    std::chrono::steady_clock::time_point asked_{};
};

/// Folders of records, and of ends of continued cases.
struct CasePlaces {
    std::filesystem::path records{}, continuation{};
};

/// A simulation in which cases run, and what observes it.
struct CaseSite {
    CaseSite(const Scene& scene, const Schedule& schedule) : simulation(scene, schedule), observer(simulation.workspace().variator) {}
    Simulation simulation;
    model::Observer observer;
};

/// Scalars and means of a case while it runs, of the time from sweep.from on.
class CaseScalars final : public RunObserver {
public:
    explicit CaseScalars(const Sweep& sweep) : sweep_(sweep) {}

    /// Ready for another case.
    void clear();
    /// Connects to a site for the next case. @param end last output of the case; infinite where it ends when it is steady [s]
    void observe(CaseSite& site, const RunSettings& run, double end) noexcept;
    /// Seeks steady means, and the mean state for the case behind. Call it before the first sample.
    void seek_steady(const SteadyRule& rule) noexcept;
    /// Means since sweep.from over the samples of scalars.
    [[nodiscard]] RunMeans& means() noexcept { return means_; }
    [[nodiscard]] const SectionMean& sections() const noexcept { return sections_; }
    /// Whether the case ends when it is steady. Scalars are then those of whole pin periods.
    [[nodiscard]] bool by_periods() const noexcept { return means_.rule().limit > 0.0; }
    void output(double time, const Workspace& workspace, const Counters& counters) override;  ///< time [s]
    [[nodiscard]] bool samples(double time) const noexcept override {
        return counts(time) && (due(time) || sections_.due(time) || output_due(time));
    }
    void sample(double time, const Workspace& workspace, const Counters& counters) override;
    void transition(const TransitionRecord& /*record*/) override {}
    /// Writes scalars, their errors and the begin of the means. A scalar of a case that ended well must be finite.
    void write(CaseResult& result) const;

private:
    /// States of the reducers at a sample of the first pin periods, in one of which whole ones begin.
    struct Early {
        double time;  ///< [s]
        std::vector<Reducer> reducers;
    };
    [[nodiscard]] bool counts(double time) const noexcept;
    [[nodiscard]] bool due(double time) const noexcept { return means_.curve().empty() || means_.curve().due(time, samples_per_pitch); }
    /// Whether a step has ended at or behind an output at which none had to end.
    [[nodiscard]] bool output_due(double time) const noexcept { return !by_periods() && time >= output_before_ + output_interval_; }
    void reduce(double time, const Workspace& workspace, const Counters& counters, const Occasion& when);
    void keep_early();
    [[nodiscard]] Reducer over_periods(std::size_t scalar, double begin) const;
    [[nodiscard]] std::span<Reducer> present_reducers();
    void write_steady(std::size_t i, CaseResult& result) const;

    const Sweep& sweep_;
    CaseSite* site_ = nullptr;
    int followed_pin_ = 0;
    double output_interval_ = 0.0;   ///< infinite where steps end at outputs [s]
    double end_ = 0.0;               ///< time from which an output is the last [s]
    std::vector<Reducer> reducers_;  ///< [scalars], or of every pin period [periods x scalars]
    std::vector<Early> early_;       ///< states that early_count_ counts, then memory for reuse
    std::size_t early_count_ = 0;
    RunMeans means_;
    SectionMean sections_;
    double output_before_ = 0.0;  ///< time of the last output [s]
    std::vector<double> values_;  ///< numbers of one channel
};

class CaseEngine final : private Pauses {
public:
    CaseEngine(const Sweep& sweep, StartStates& starts, BatchControl& control, CasePlaces places);

    /// Runs a case. Never throws for errors of the case; engine::RecordError if something cannot be written.
    [[nodiscard]] const CaseResult& run(long number);
    /// Runs a case from the start that it has without continuation, with neither a record nor an end for its neighbour.
    /// @param until later end of a case that ends when it is steady; 0: none [s]
    [[nodiscard]] const CaseResult& run_from_own_start(long number, double until = 0.0);
    /// The result of a case that took its process down.
    [[nodiscard]] const CaseResult& book_crash(long number, const std::string& why);

private:
    void prepare();
    void begin(const ContinuedStart& from);
    void integrate();
    [[nodiscard]] Fault attempt(ContinuedStart from);
    [[nodiscard]] bool astray();
    [[nodiscard]] Fault run();
    [[nodiscard]] bool due(double time, const Counters& counters) override;
    [[nodiscard]] bool pass() override { return false; }
    [[nodiscard]] double elapsed() const;

    const Sweep& sweep_;
    StartStates& starts_;
    BatchControl& control_;
    CasePlaces places_;
    Scene scene_;
    CaseResult result_;
    CaseScalars scalars_;
    RunHistory history_;
    std::unique_ptr<CaseSite> at_;  ///< site of the present case
    bool own_start_ = false;
    double longer_ = 0.0;  ///< end of the run in place of the scene's; 0: none [s]
    RunEnd end_{};
    std::unique_ptr<RunRecorder> recorder_;
    RunOptions record_options_;
    engine::Cancellation never_;
    std::chrono::steady_clock::time_point started_;
    StrandEnds ends_;
};

/// Cost of a step: evaluations x unknowns.
[[nodiscard]] double step_cost(const Scene& scene);

/// Cost of cases, that of their steps: for estimates.
class CaseCosts {
public:
    explicit CaseCosts(const Sweep& sweep) : sweep_(sweep) {}
    /// Cost of a run; of one until it is steady that of its usual length. @param continued  the case starts from another
    [[nodiscard]] double of_run(const Scene& scene, bool continued = false) const;
    [[nodiscard]] double of_settling(const Scene& scene) const;
    /// Whether the case settles, judged by its level of detail. In a sweep with shared starts none does.
    /// @throws as saved_start
    [[nodiscard]] bool settles(const Scene& scene);

private:
    const Sweep& sweep_;
    std::string known_;  ///< file of the following state
    std::shared_ptr<const engine::SavedState> state_;
    std::optional<model::ChainLayout> settled_;
};

}  // namespace cvtflow::tasks
