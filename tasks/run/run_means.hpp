#pragma once
/// Means of a run over time, over all of it and over its first and last fifth, what is odd about them, and whether they are reliable. They
/// come from integrals over time, whose memory does not grow with the run; means of blocks of whole pin periods show their errors.

#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tasks/run/mean_curve.hpp"
#include "tasks/run/note_kinds.hpp"
#include "tasks/step/fault.hpp"

namespace cvtflow::tasks {

class Workspace;

/// Means over a span of time: over its last whole pin periods, where it has one; zero where nothing was seen.
struct SpanMeans {
    double begin = 0.0, end = 0.0;         ///< [s]
    double periods = 0.0;                  ///< whole pin periods between them; 0: less than one [1]
    double ratio = 0.0, slip = 0.0;        ///< [1]
    double friction_slip = 0.0;            ///< [1]
    double loss_slip = 0.0;                ///< power lost by creep over the power of shafts that bring any; 0 where none does [1]
    double tight = 0.0, slack = 0.0;       ///< [N]
    double limited = 0.0;                  ///< share of time in which a controller had reached its authority
    double missed = 0.0;                   ///< deviation of the first controller's quantity over its target [1]
    double swing = 0.0;                    ///< swing of a controlled clamping force, see min_swing() [1]
    double loose = 0.0;                    ///< share of time in which a strand carried no tension
    double beyond = 0.0;                   ///< share of time in which clamping was above its limit over the slip speed
    double floor = 0.0;                    ///< share of time in which the table of shaft 2 decided its force, and not clamping.safety
    double turning = 0.0;                  ///< speed of the shafts without its sign, mean of both [rad/s]
    std::array<double, 2> speed{};         ///< [rad/s]
    std::array<double, 2> torque{};        ///< torques of drive and load [N·m]
    std::array<double, 2> chain_torque{};  ///< torques of the chain on the shafts [N·m]
    std::array<double, 2> clamping{};      ///< [N]
    std::array<double, 2> radius{};        ///< [m]
    std::array<double, 4> axial_force{};   ///< forces on sheaves 1-, 1+, 2-, 2+ [N]
    double efficiency = 0.0;               ///< 1 - losses/input; not a number without input or without load [1]
    double input = 0.0, taken = 0.0;       ///< power of the inputs that brought energy, and of those that took any [W]
    std::array<double, 2> shaft_power{};   ///< powers of drive and load, negative: taken out [W]
    std::array<double, 2> drag{};          ///< power that seals, bearings and oil take from the shafts [W]
    double lost = 0.0;                     ///< losses of the variator and by the drag of its shafts [W]
    double stored = 0.0;                   ///< change of the stored energy over the input; 0 without input [1]
    bool no_load = false;                  ///< no shaft took a hundredth of the input: there is no efficiency
    model::HydraulicEnergy hydraulics{};   ///< mean powers [W]; `stored` is the mean rate of what is stored
    double with_pump = 0.0;                ///< efficiency with the pump's power and losses; as efficiency where there is no pump [1]
    double overall = 0.0;                  ///< efficiency from outside to outside: with pump and drag of the shafts [1]
    double carried = 0.0;                  ///< power that drive and load took out of the machine over its losses [1]
    double target = 0.0;                   ///< target of the first controller [1]
    double astray = 0.0;                   ///< mean distance of the speed of shaft 2 from what a cycle needs, over that [1]
    double short_of = 0.0;                 ///< missing work of shaft 2 over what a cycle needs, without its sign [1]

    /// Words "begin", "end" and channels, each followed by its number, of the means that channels have.
    [[nodiscard]] std::string text() const;
    /// Whether the machine misses its cycle: by more than 2 % in speed or work.
    [[nodiscard]] bool cycle_missed() const noexcept;
};

/// Largest deviation of a run from its cycle.
struct CycleMiss {
    double time = 0.0;   ///< [s]
    double share = 0.0;  ///< speed of shaft 2 over what is needed, less 1

    /// "the machine misses its cycle: …". @param whole of the run
    [[nodiscard]] std::string text(const SpanMeans& whole) const;
};

/// Something about results that a reader must know. They are right by themselves.
struct Note {
    std::string_view name;  ///< name in tables: gross_slip, …
    std::string text;       ///< sentence for people
};

struct Scene;

/// Rule of run.until = "steady"; none for other scenes.
[[nodiscard]] SteadyRule steady_rule(const Scene& scene) noexcept;

class RunMeans {
public:
    void clear() noexcept;
    /// Takes means over the last half of the time and checks them by the rule, if it has a tolerance. Call it before the first sample.
    void seek_steady(const SteadyRule& rule) noexcept;
    /// A sample. @param sums of the energies so far   @param pin_period see Workspace [s]   @param mark of the energies' ledger
    /// @param needed_speed of shaft 2, by a cycle; 0: none [rad/s]
    void add(const model::Observation& now, const EnergySums& sums, double pin_period, const EnergyMark& mark = {},
             double needed_speed = 0.0);
    /// Whether the run should end: its means are steady, will not become so within the rule's limit, or have no pin periods.
    [[nodiscard]] bool ended() const noexcept { return ended_; }
    /// Checks at the end of a run that another rule ended.
    void conclude() noexcept { steady_ = steady_means(curve_, rule_); }
    /// Result of the last check; no batches: none yet.
    [[nodiscard]] const SteadyMeans& steady() const noexcept { return steady_; }
    [[nodiscard]] const SteadyRule& rule() const noexcept { return rule_; }
    /// Reason why a run that ended is not steady; none if it is.
    [[nodiscard]] Fault steady_fault() const noexcept;
    /// Energies' ledger at the begin of the means. Without a rule where the run began.
    [[nodiscard]] EnergyMark mark() const noexcept { return curve_.empty() ? EnergyMark{} : curve_.at(begin()).mark; }
    [[nodiscard]] const MeanCurve& curve() const noexcept { return curve_; }

    [[nodiscard]] SpanMeans all() const { return span(0.0, 1.0); }
    /// k: 0 … 4, the last one
    [[nodiscard]] SpanMeans fifth(int k) const { return span(0.2 * k, k < 4 ? 0.2 * (k + 1) : 1.0); }
    [[nodiscard]] const CycleMiss& cycle_miss() const noexcept { return miss_; }
    /// Errors of all(); no batches: too short to know them.
    [[nodiscard]] MeanErrors errors() const noexcept;

    /// All that a checkpoint has to keep.
    void visit(engine::Archive& archive);

private:
    void check_steady() noexcept;
    void end_control() noexcept;                                 ///< calls judge_control() once it can
    [[nodiscard]] double begin() const noexcept;                 ///< begin of the means [s]
    [[nodiscard]] double end() const noexcept;                   ///< [s]
    [[nodiscard]] SpanMeans span(double from, double to) const;  ///< from, to: shares of the time of the means [1]

    MeanCurve curve_;
    SteadyRule rule_;
    SteadyMeans steady_;
    CycleMiss miss_;
    double next_check_ = 0.0;  ///< [pin periods]
    bool ended_ = false;
};

/// Notes on unusual results. @param balance of the run   @param pulleys whether there are any: else only losses are checked
[[nodiscard]] std::vector<Note> notes(const RunMeans& means, const EnergyBalance& balance, bool pulleys = true);
/// Writes the names of notes to `names`, separated by blanks.
void name_notes(const RunMeans& means, const EnergyBalance& balance, std::string& names);

/// Adds the sample of a workspace at `time` [s], as `now` observes it.
void add_sample(RunMeans& means, const model::Observation& now, const Workspace& workspace, double time);

}  // namespace cvtflow::tasks
