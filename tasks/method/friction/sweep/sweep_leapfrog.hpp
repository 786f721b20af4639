#pragma once
/// Leapfrog with friction solved for where it acts: by a few implicit sweeps over the contacts of each joint and link, which begin with the
/// forces of the step before. It is backward Euler on velocities alone,
/// nearly converged.
///
///     opening    joints and links with the forces of the step before, then plates and tips of each link
///     middle     joints, plates and tips once more, as often as the plan states
///     closing    joints; velocities and coordinates at the end
///
/// Forces that outlast a step belong to the state of the integration: they are saved, and a step that is cut takes up those that the whole
/// step has begun with. A first step has none: it takes `first_sweeps`.

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "tasks/method/friction/leapfrog_frame.hpp"
#include "tasks/method/friction/sweep/sweep_system.hpp"
#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

/// What sweeps need that parameters do not have, as a setting: pin halves, and a friction law without a rounded corner. Empty: nothing.
[[nodiscard]] std::string_view missing_for_sweeps(const model::Parameters& parameters) noexcept;
/// Whether sweeps are the automatic choice: parameters have what they need, tips have no phases stick and slip (whose losses were not
/// compared), and friction does not saturate at so low a speed that more sweeps would be needed than a step has.
[[nodiscard]] bool sweeps_suit(const model::Parameters& parameters);

/// @tparam Number of velocities inside the step: double or float
template <class Number>
class SweepLeapfrog final : public StepMethod {
public:
    /// Slots of the workspace that the method uses.
    static constexpr int state_slots = LeapfrogFrame::state_slots, slope_slots = LeapfrogFrame::slope_slots;
    /// Sweeps of a step without a step before.
    static constexpr int first_sweeps = 30;

    /// For parameters with nothing missing_for_sweeps().
    explicit SweepLeapfrog(Workspace& workspace);

    [[nodiscard]] NextCycle begin() override;
    [[nodiscard]] NextCycle next() override;
    void add_tasks(engine::TaskGraph& graph) override;
    void repartitioned() override { system_.repartition(w_.partition); }
    [[nodiscard]] bool retakes() const noexcept override { return true; }
    /// Contact begins with no force at all; only with stick and slip the phase decides a force.
    [[nodiscard]] bool keeps_steps() const noexcept override { return !w_.parameters.detail.stick_slip; }
    [[nodiscard]] long observation_stride() const noexcept override { return 12; }
    void restart() noexcept override;
    void transition() noexcept override {}  // forces stay good: that of a tip that has just landed is zero
    void save(std::vector<double>& memory) const override;
    void load(std::span<const double> memory) override;  ///< memory [what save() wrote]

    [[nodiscard]] std::optional<std::size_t> bytes() const noexcept override { return system_.bytes(); }

    // Bodies of tasks.
    void record(int segment) noexcept;
    void sweep(int item) noexcept;  ///< item = pass of the cycle × segments + segment
    void book(int item) noexcept;   ///< losses by friction in an observe cycle, after all else; item 0

private:
    enum class State { evaluating, recording, sweeping };

    NextCycle next_passes();
    void add_passes(engine::TaskGraph& graph, int cycle, int passes);
    void add_booking(engine::TaskGraph& graph);

    Workspace& w_;
    LeapfrogFrame frame_;
    SweepSystem<Number> system_;
    const int sweeps_;  ///< of a step
    State state_ = State::evaluating;
    int pass_ = 0;               ///< the first that is in no cycle yet
    int passes_ = 0;             ///< of the step at hand
    int begun_ = 0;              ///< the first pass of the cycle at hand
    double begun_length_ = 0.0;  ///< of the step before, as it was begun [s]
    double nominal_ = 0.0;       ///< of steps that nothing cuts short: the longest, or the last that was as long as the one before [s]
    bool cold_ = true;           ///< the step at hand has none before it
};

}  // namespace cvtflow::tasks
