#pragma once
/// A whole run of a scene: settle if needed, integrate, record, sum up. The work of `cvtflow run`, as a function; and its report.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/record/run/part_file.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/run/run_means.hpp"
#include "tasks/run/simulation.hpp"

namespace cvtflow::tasks {

/// A coupling of a shaft at the end of a run.
struct CouplingReport {
    int shaft = 0;                            ///< 0, 1
    double twist = 0.0;                       ///< angle of the far end less that of the shaft [rad]
    double stored = 0.0;                      ///< [J]
    double far_work = 0.0, dissipated = 0.0;  ///< work at the far end (negative: taken out) and losses, since t = 0 [J]
};

/// Mean values from t = 0 on, and what the run took.
struct RunReport : RunHistory {
    Fault fault;
    EnergyBalance energy;                      ///< balance of the run, without settling
    double balance_error_ratio = 0.0;          ///< larger one of run and settling; above 1 the results are unreliable
    JudgedBalance judged;                      ///< balance of the run that is farthest from closing
    double settling_residual = 0.0;            ///< relative residual of the energy balance of settling
    SpanMeans whole, first_fifth, last_fifth;  ///< means of the run; with run.until = "steady" of its last half
    CycleMiss cycle_miss;                      ///< largest miss of a run with a cycle
    MeanErrors errors;                         ///< errors of `whole`
    double revolutions = 0.0;                  ///< revolutions of the chain before the means begin; 0: without run.until = "steady"
    std::vector<CouplingReport> couplings;     ///< reports of the coupled shafts
    model::TripSums trip{};                    ///< sums of the cycle at the end; zero without one
    model::HeatBalance heat;                   ///< temperatures at the end
    std::vector<Note> notes;                   ///< unusual features of correct results
    std::vector<std::string> start_differences;
    double end = 0.0;          ///< simulated time [s]
    double step = 0.0;         ///< step last in use [s]
    AutoNumber step_setting;   ///< run.step
    double stable_step = 0.0;  ///< largest stable step where the run began or an automatic step was last chosen; 0: unknown [s]
    std::string method;
    std::string method_report;    ///< counters of the method, one line; may be empty
    std::string schedule;         ///< schedule that ran, with the reason if it was chosen
    std::string kernels;          ///< instruction set that the kernels used
    std::size_t working_set = 0;  ///< memory that the step loop touches, of workspace and method [B]
    bool counts_method = true;    ///< false: the method does not count its part of it
    Counters counters;            ///< counters after settling
    StepControl step_control = StepControl::fixed;
    double tolerance = 0.0;             ///< [1]
    LocalErrorStatistics local_errors;  ///< errors after settling
    std::uint64_t hash = 0;
    long outputs = 0;

    bool has_pulleys = true;

    [[nodiscard]] bool reliable() const noexcept { return balance_error_ratio <= 1.0; }
    /// "finished", "unreliable", "cycle_missed", or the fault's name, which goes first: the summary also reports a run that ended early
    /// and is unreliable.
    [[nodiscard]] std::string status() const {
        if (fault) return fault.name();
        return !reliable() ? "unreliable" : whole.cycle_missed() ? "cycle_missed" : "finished";
    }
    /// Whether run.step was given and is beyond what the method is stable for.
    [[nodiscard]] bool beyond_stability() const noexcept { return !step_setting.automatic() && step > stable_step && stable_step > 0.0; }
};

/// Reports of the coupled shafts, as they are now.
[[nodiscard]] std::vector<CouplingReport> couplings_of(const Simulation& simulation);

/// One line about a balance that does not close.
[[nodiscard]] std::string unreliable_text(const RunReport& report);

/// The report as lines of text for a person.
[[nodiscard]] std::string summary(const RunReport& report);

/// Progress of a run, delivered at output times.
struct Progress {
    double begin, time, until;  ///< [s]; settling has begin < 0 = until
    double wall;                ///< wall time since the run began [s]
    const Counters& counters;
    [[nodiscard]] bool settling() const noexcept { return begin < 0.0; }
};

struct RunOptions {
    engine::OutputFile file;                        ///< record to write; empty: none. With `from`, the one to continue
    std::function<void(const Progress&)> progress;  ///< called at every output time, serially
    const engine::Cancellation* cancel = nullptr;
    std::string checkpoint;                          ///< file to write checkpoints to; empty: none
    double checkpoint_every = 0.0;                   ///< wall time between checkpoints, at output times; 0: only if the run ends early [s]
    std::function<void(const std::string&)> notice;  ///< receives warnings before the run begins
    const Checkpoint* from = nullptr;                ///< checkpoint to resume
    bool mixed = false;                              ///< accepts, with `from`, a checkpoint of another version of the program
};

/// Runs the scene to run.until. A fault ends the run with what was recorded so far on file and is part of the report.
/// A run that ends early (cancelled, budget) writes a checkpoint if RunOptions::checkpoint is set. A finished one deletes its checkpoint,
/// if the record contains its state.
/// @throws SimulationError (also if the run would end before its checkpoint), engine::RecordError, std::invalid_argument before the run;
/// engine::RecordError during it (disk full)
[[nodiscard]] RunReport run_scene(const Scene& scene, const RunOptions& options);

/// Settling ended before t = 0.
class SettlingFault : public SimulationError {
public:
    explicit SettlingFault(Fault why) : SimulationError("settling: " + why.message()), fault(why) {}
    Fault fault;
};

/// Settles a scene's geometric start and writes the state at t = 0.
/// @return EnergyLedger::balance_error_ratio(): above 1 the state is wrong; also stored in the file
/// @throws as run_scene; SettlingFault, and then writes nothing
double settle_scene(const Scene& scene, const engine::OutputFile& state_file, const RunOptions& options);

}  // namespace cvtflow::tasks
