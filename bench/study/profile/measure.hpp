#pragma once
/// Schedules measured alternately in one process: A B C A B C …, so that disturbances affect all alike; medians over rounds.
/// A round continues where the last one ended, so a fast schedule gets further in simulated time: some microseconds, over which a step's
/// cost hardly changes.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/study/profile/stages.hpp"
#include "bench/study/profile/statistics.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::bench {

/// Time of a number of steps.
struct TrialSample {
    double wall = 0.0;  ///< [s]
    double cpu = 0.0;   ///< processor time of the whole process, all threads [s]
    long steps = 0;
    long evaluations = 0;

    [[nodiscard]] double per_step() const noexcept { return wall / static_cast<double>(steps); }
};

/// One schedule, running from a copy of a scene's start.
class Trial {
public:
    /// @throws as Simulation
    Trial(const tasks::Scene& scene, const tasks::Schedule& schedule, engine::StampRecorder* recorder = nullptr);

    /// Runs to t = 0 if the scene's start has not settled yet. @throws SimulationError if the simulation ends by itself
    void settle();

    /// Takes `steps` further steps, or fewer if they take longer than `timeout` [s], which is checked once per output interval. The search
    /// for the automatic step, which a run does once, is in the first call only (before a start has settled: in every call).
    /// @throws SimulationError if the simulation ends by itself: there is nothing to measure then
    TrialSample run(long steps, double timeout = 3600.0);

    [[nodiscard]] const tasks::Simulation& simulation() const noexcept { return simulation_; }

private:
    tasks::Simulation simulation_;
    bool begun_ = false;
};

/// Steps that fit into `seconds` at `per_step`; 1 to 100 000. seconds [s], per_step [s]
[[nodiscard]] long steps_within(double seconds, double per_step) noexcept;

/// Cost of an executor's synchronisation, apart from any chain.
struct CycleCost {
    double seconds = 0.0;  ///< time per cycle beyond the task's [s]
    int active = 0;        ///< threads that ran at least a quarter of their share of tasks
};

/// Cycles of one task of about 2 us per thread, in a graph of one level: their time above that of a single task run serially just before;
/// medians over batches, bounded by wall time. Threads that never come (busy machine) make it meaningless: see `active`.
[[nodiscard]] CycleCost cycle_cost(const tasks::Schedule& schedule, double seconds);

struct MeasureOptions {
    int rounds = 5;                        ///< besides one that warms up
    double round_seconds = 0.06;           ///< steps of a round are chosen to take about that long [s]
    long steps = 0;                        ///< steps of a round; 0: chosen
    double timeout = 2.0;                  ///< a schedule with a longer round is dropped [s]
    std::vector<int> neighbours{0, 1, 2};  ///< busy threads beside; ascending, 0 first
};

/// One schedule beside a number of busy neighbours.
struct LoadResult {
    int neighbours = 0;
    Spread step;                ///< [s]
    double evaluation = 0.0;    ///< median time per evaluation of the right-hand side, detection and control included [s]
    double cpu_per_wall = 0.0;  ///< processors kept busy by this process, neighbours not counted [1]
    double speed_up = 0.0;      ///< median of serial over median of this, under the same load [1]
    int rounds = 0;             ///< rounds that count; 0: not measured
    std::string dropped;        ///< reason for missing rounds; empty: none is missing
    double cpu = 0.0;           ///< median processor time of this process per step, neighbours not counted [s]
    double burnt = 0.0;         ///< part of cpu that serial does not need under the same load: burnt while waiting, or lost to caches [s]
};

/// Threads that meet faster than this are near [s].
inline constexpr double near_meeting = 0.25e-6;

/// Gain over serial's turn of the same round, separately for near and far rounds. Near: a bare barrier of as many threads, unpinned, took
/// at most near_meeting just before.
struct PairedGain {
    Spread near, far;  ///< [1]
    int near_rounds = 0, far_rounds = 0;
};

/// A recorded pass, separate from the timing.
struct Recording {
    RecordedPass pass;
    Spans spans;
    std::vector<std::string> tasks;  ///< names of tasks, by number
    long steps = 0;
    long lost = 0;      ///< stamps that did not fit
    double cost = 0.0;  ///< relative increase of the step time by recording
};

struct ScheduleResult {
    tasks::Schedule schedule;
    std::string name;               ///< "flow:fused"
    std::vector<LoadResult> loads;  ///< results in the order of MeasureOptions::neighbours
    Recording recording;
    CycleCost cycle;         ///< synchronisation of the executor by itself: median over rounds
    double bare = 0.0;       ///< a bare barrier of as many threads, measured in turn with it [s per cycle]
    PairedGain paired;       ///< gain without neighbours
    std::uint64_t hash = 0;  ///< hash after `hash_steps` steps
    long hash_steps = 0;
};

/// "flow:fused"
[[nodiscard]] std::string schedule_name(const tasks::Schedule& schedule);

/// One line for each result whose hash differs from that of the first after as many steps. `short_hash` is that of the first after 4 steps.
[[nodiscard]] std::vector<std::string> hash_differences(const std::vector<ScheduleResult>& results, std::uint64_t short_hash);

/// A schedule under measurement.
struct ScheduleTrial {
    std::unique_ptr<Trial> trial;
    ScheduleResult result;
    std::vector<CycleCost> cycles;  ///< one per round without neighbours
    std::vector<double> bare;       ///< [s]
    bool dropped = false;
};

/// Gain of as many independent serial runs at once as there are threads: the machine's gain without any synchronisation.
struct CopiesGain {
    int threads = 0;
    PairedGain paired{};
};

/// Independent serial runs under measurement.
struct CopiesTrial {
    std::vector<std::unique_ptr<Trial>> trials;  ///< [threads]
    std::vector<double> step;                    ///< one per round without neighbours: time per step at their combined rate [s]
    std::vector<double> bare;                    ///< [s]
    CopiesGain result{};
};

/// @param serial, step one per turn, those of the rounds that count last [s]   @param bare one per round that counts [s]
[[nodiscard]] PairedGain paired_gain(const std::vector<double>& serial, const std::vector<double>& step, const std::vector<double>& bare,
                                     int rounds);

/// One for each number of threads from 2 on, up to the usable ones.
[[nodiscard]] std::vector<CopiesTrial> start_copies(const tasks::Scene& scene, const std::vector<tasks::Schedule>& schedules);

/// Builds the trials, runs 4 steps of each and, unless they were slow, 36 more, and keeps the hashes.
/// @param short_hash [out] of the first schedule after 4 steps
[[nodiscard]] std::vector<ScheduleTrial> start_lanes(const tasks::Scene& scene, const std::vector<tasks::Schedule>& schedules,
                                                     double timeout, std::uint64_t& short_hash);

/// Stages of all lanes' graphs.
[[nodiscard]] StageTable stages_of(const std::vector<ScheduleTrial>& lanes);

/// Alternating rounds beside `neighbours` busy threads. The first lane is the reference of speed-ups. Without neighbours some cycles of the
/// executor by itself and of a bare barrier come before every turn, and copies have turns, too.
void measure_load(std::vector<ScheduleTrial>& lanes, std::vector<CopiesTrial>& copies, const MeasureOptions& options, int neighbours);

/// A recorded trial beside the unrecorded one, alternating; keeps the recorded round of median length.
void record_lane(const tasks::Scene& scene, ScheduleTrial& lane, const MeasureOptions& options, const StageTable& stages);

}  // namespace cvtflow::bench
