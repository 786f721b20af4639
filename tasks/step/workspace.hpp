#pragma once
/// All memory of the step loop, taken once. Every number has one writer per cycle: the segment that owns the link, or the controller.

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "engine/event/interpolant.hpp"
#include "engine/method/compiled_plan.hpp"
#include "model/law/phase_rule.hpp"
#include "model/machine/heat_balance.hpp"
#include "model/machine/vehicle.hpp"
#include "model/observe/observation.hpp"
#include "model/rigid/rigid_chain.hpp"
#include "model/variator/variator.hpp"
#include "tasks/step/control/cycle_sequence.hpp"
#include "tasks/step/control/energy_ledger.hpp"
#include "tasks/step/control/step_control.hpp"
#include "tasks/step/fault.hpp"

namespace cvtflow::tasks {

/// Links [first, last).
struct Segment {
    int first, last;
    [[nodiscard]] int size() const noexcept { return last - first; }
    bool operator==(const Segment&) const = default;
};

class Partition {
public:
    /// Segments begin at multiples of this number of links for kernels with `lanes` links side by side, as do vectors and sums of
    /// reactions. With vectors of eight lanes half a vector is good enough: two threads need five and six of them either way, and costs per
    /// link are better balanced (40 and 44 links instead of 48 and 36).
    [[nodiscard]] static int grain(int lanes) noexcept { return std::min(lanes, model::links_per_sum); }

    /// `segments` runs of equal length, up to `grain` links; they begin at multiples of it, as long as there are enough of those.
    /// Throws std::invalid_argument unless 1 ≤ segments ≤ links.
    static Partition equal(int links, int segments, int grain = 1);

    /// Segments between the given cuts: 0 = cuts[0] < cuts[1] < … = number of links. Throws std::invalid_argument otherwise.
    static Partition at(const std::vector<int>& cuts);

    [[nodiscard]] std::span<const Segment> segments() const noexcept { return segments_; }
    [[nodiscard]] const Segment& operator[](int segment) const noexcept { return segments_[static_cast<std::size_t>(segment)]; }
    [[nodiscard]] int size() const noexcept { return static_cast<int>(segments_.size()); }

private:
    std::vector<Segment> segments_;
};

/// Stages, slots, links and tips are counted in int; the standard library indexes by size_t.
[[nodiscard]] inline std::size_t at(int index) noexcept { return static_cast<std::size_t>(index); }

/// A transition of one tip within the present step.
struct Transition {
    double theta = 2.0;                    ///< share of the step at which it is due; > 1: none
    int tip = -1;                          ///< 4 link + 2 end + side
    model::Phase to = model::Phase::free;  ///< phase after the transition
};

/// Result of a segment in a detect, locate or truncate cycle.
struct alignas(64) SegmentResult {
    Transition first;      ///< earliest transition of the segment's tips
    long detected = 0;     ///< transitions found in this cycle
    long suppressed = 0;   ///< transitions put off because the tip has just changed
    bool pending = false;  ///< some tip has to be located; or, where the method finds transitions, the state to be checked
    Fault fault;
};

/// Treatment of a step in which tips are due to change their phase.
enum class AtTransition {
    interpolate,  ///< the step is cut on the cubic through both ends and their slopes, of which slopes[0] must hold that at the start
    repeat,       ///< the step is repeated up to the transition, found by positions and velocities at both ends
    inside        ///< the method has changed the phases itself: nothing is searched for
};

/// The present step; written by the controller between cycles, read by every task.
struct alignas(model::cache_line) StepInput {
    double time = 0.0;                                       ///< t at the step's start [s]
    double h = 0.0;                                          ///< length of the step [s]
    double output = 0.0;                                     ///< last time at which a step had to end, for an output [s]
    double dwell = 0.0;                                      ///< minimum time between two phase changes of a tip [s]
    double search_until = 0.0;                               ///< end of the proposed step; transitions are searched for up to here [s]
    engine::PlanStep row{};                                  ///< stage or result that an evaluate cycle combines
    double theta = 1.0;                                      ///< place at which a truncate cycle cuts, share of the step
    bool estimate_error = false;                             ///< a detect cycle also estimates the local error of its links
    engine::PlanStep error_row{};                            ///< row that combines the error
    ErrorScale error_scale;                                  ///< units of the error
    Transition due;                                          ///< transition at which a truncate cycle cuts
    long evaluations = 0;                                    ///< evaluations of the right-hand side so far
    double* slope_out = nullptr;                             ///< [layout.size()] where an evaluate cycle writes slopes
    bool evaluate_end = false;                               ///< an evaluate cycle works at the end of the step instead of a stage
    AtTransition at_transition = AtTransition::interpolate;  ///< treatment of transitions by the method

    /// Whether slopes at both ends are made from the states there.
    [[nodiscard]] bool slopes_from_states() const noexcept { return at_transition != AtTransition::interpolate; }
};

/// Results of each link: written by the link's segment (Field::load, account, link_error), summed by the controller in a fixed order.
struct LinkFields {
    model::LineVector<model::LinkLoad> loads;  ///< [links]
    /// [2 variator.sums()] of loads: one per group for the shaft of its first touching link, then one per group for the other; by the
    /// segment that has all links of a sum, in a fused evaluate cycle
    model::LineVector<model::SheaveSum> sums;
    std::vector<int> split_sums;           ///< sums whose links several segments share
    std::vector<model::Account> accounts;  ///< [links * account_parts], by an observe cycle; with a ledger in the state by every evaluation
    std::vector<model::LinkContact> contacts;  ///< [links] by an observe cycle, where `observed` is set
    bool observed = false;                     ///< set before an observe cycle: what it leaves is for observers, too, until the next step
    std::vector<double> errors;                ///< [links] local error of the step, root mean square in units of error_scale
};

/// Whether tips touch: changed in truncate cycles or by the method (Field::phase), probed in detect cycles (Field::before, after).
struct TipState {
    std::vector<model::Phase> phases;         ///< [4 links]
    std::vector<model::Phase> phases_before;  ///< [4 links] before a truncate cycle
    std::vector<model::TipIndicator> before;  ///< [4 links] at the step's start
    std::vector<model::TipIndicator> after;   ///< [4 links] at its end
    std::vector<model::TipProbe> probes;      ///< [links] the same with the links' radii
    std::vector<double> changed;              ///< [4 links] time of the last change of phase [s]
    bool have_changed = false;                ///< a phase changed in the present step (AtTransition::inside)
};

/// Memory of an assembly of the laboratory in a workspace (FurtherAssembly).
class AssemblyMemory {
public:
    virtual ~AssemblyMemory() = default;
    /// Called after every change of the tips' phases.
    virtual void phases_changed() noexcept = 0;
};

/// State behind the links: pulleys, control and ledger; written by the controller.
struct PulleyFields {
    std::vector<double> tail;                                     ///< [tail_size()] stage state
    alignas(model::cache_line) model::SheaveMotion sheaves[4]{};  ///< sheaves at the stage
    model::SheaveMotion end_sheaves[4]{};                         ///< sheaves at the step's end
    model::SheaveMotion observed_sheaves[4]{};                    ///< sheaves at the step's start, for an observe cycle
};

class Workspace {
public:
    Workspace(const model::Parameters& parameters, const engine::StagePlan& plan, Partition partition);
    Workspace(const Workspace&) = delete;
    Workspace& operator=(const Workspace&) = delete;

    model::Parameters parameters;  ///< changed by adopt() only, as variator and rule
    model::Variator variator;      ///< constant but for held inputs
    const engine::CompiledPlan plan;
    model::PhaseRule rule;

    Partition partition;  ///< changed by repartition() only

    StepInput step;

    // Fields over the state vector: [slot][layout.size()].
    std::vector<double*> states;  ///< state slots; 0 = y at the step's start, unless columns have it: see state()
    std::vector<double*> slopes;  ///< slope slots; 0 = slope at the step's start
    double* end_state;            ///< y at the step's end
    double* end_slope;            ///< slope at the step's end with the phases of the step, only if a transition has to be located
    double* cut_state;            ///< y at theta [unknowns]

    LinkFields links;
    TipState tips;
    PulleyFields pulleys;

    std::vector<model::LineVector<double>> windows;  ///< [segments] stage states of the segment's links and of the layout's halo
    std::vector<SegmentResult> segment_results;      ///< [segments]
    FrameMemory frame;                               ///< frame of the controller's coroutine
    EnergyLedger energy;                             ///< works, losses and balance of the present part, written by the controller
    model::HeatBalance heat;                         ///< temperatures, changed at outputs by the controller
    model::Trip trip;                                ///< trip of the scene's vehicle; empty without a cycle
    std::unique_ptr<AssemblyMemory> further;         ///< memory of the laboratory's assembly; nullptr in the product
    bool sums_missing = false;                       ///< evaluate cycles of the present assembly do not fill links.sums

    [[nodiscard]] const model::ChainLayout& layout() const noexcept { return variator.layout(); }
    /// y at the step's start, to observe, save or judge it; between two cycles only. While columns have the state, every call copies them.
    /// @return [layout.size()]
    [[nodiscard]] const double* state() const noexcept;
    /// Columns of rigid pins, for a method that steps them there. They have the state, and states[0] is out of date, from the next
    /// columns_advanced() until state_to_set() or adopt().
    [[nodiscard]] model::RigidState& columns();
    /// nullptr: no method has asked for them.
    [[nodiscard]] const model::RigidState* rigid_pins() const noexcept { return columns_.get(); }
    void columns_advanced() noexcept { columns_have_state_ = true; }
    /// Observation of y at the step's start, with the forces of the step behind it where columns have the state. time [s]
    [[nodiscard]] const model::Observation& observed_by(model::Observer& observer, double time) const noexcept {
        if (columns_have_state_) return observer.observe(time, *columns_);
        const model::EvaluatedLinks evaluated{links.loads.data(), links.accounts.data(), links.contacts.data()};
        return observer.observe(time, state(), tips.phases.data(), links.observed ? &evaluated : nullptr);
    }
    /// Observation without the chain (Observer::observe_shafts). time [s]
    [[nodiscard]] const model::Observation& shafts_observed_by(model::Observer& observer, double time) const noexcept {
        return observer.observe_shafts(time, tail());
    }
    /// Writable state y, between two runs; the caller then calls StepMethod::restart.
    [[nodiscard]] double* state_to_set() noexcept {
        static_cast<void>(state());
        columns_have_state_ = links.observed = false;
        return states[0];
    }
    /// Replaces the variator by one of the same layout, at rest before its start; between runs only.
    void adopt(const model::Parameters& other);
    /// The tips' law takes the temperatures that are: at a start, and where an integration resumes.
    void warm() noexcept { variator.warm(parameters, heat.film()); }
    /// Sets other segments; while no executor runs, and between two steps. Then call StepMethod::repartitioned.
    void repartition(Partition parts);
    /// Reports a change of phases to the assembly. Call it after every one.
    void phases_changed() noexcept {
        if (further) further->phases_changed();
    }
    /// The part of y behind the links; until the next cycle. @return [tail_size()]
    [[nodiscard]] const double* tail() const noexcept;
    /// Time in which a pin reaches the position of the next one, by the chain's mean speed; 0: at rest [s].
    [[nodiscard]] double pin_period() const noexcept;
    /// Time in which a pin reaches the position of the next one at a mean speed; 0: at rest. speed [m/s]
    [[nodiscard]] double pin_period(double speed) const noexcept;
    /// Place of the middle of a pin's rear half; of a rigid pin's [m].
    [[nodiscard]] std::array<double, 3> rear_half(int pin) const noexcept;
    [[nodiscard]] int tail_size() const noexcept { return layout().size() - layout().pulley_begin(); }
    [[nodiscard]] engine::SlotView slots() const noexcept { return {states.data(), slopes.data()}; }
    [[nodiscard]] engine::Interpolant interpolant() const noexcept { return {states[0], slopes[0], end_state, end_slope, step.h}; }
    /// Memory that the step loop touches here: slots, windows, fields over links and tips, the model's constants [B].
    [[nodiscard]] std::size_t bytes() const noexcept;

private:
    model::LineVector<double> memory_;
    std::unique_ptr<model::RigidState> columns_;
    bool columns_have_state_ = false;
};

/// Adds up the reactions of a segment's links, for sums that contain no link of another segment.
void add_up(Workspace& w, const Segment& bounds) noexcept;
/// Forces of the chain on the sheaves after an evaluate cycle; called by the controller.
[[nodiscard]] model::SheaveForces sheave_forces(Workspace& w) noexcept;
/// Angular momentum of both shafts with their sheaves; zero without pulleys [N·m·s].
[[nodiscard]] std::array<double, 2> shaft_momentum(const Workspace& w) noexcept;

}  // namespace cvtflow::tasks
