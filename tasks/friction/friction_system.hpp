#pragma once
/// The friction of a step: velocities of all links under friction and constant accelerations, everything else frozen, as a small system of
/// ordinary differential equations that a table of stages integrates inside the step, by segments.

#include <span>
#include <utility>
#include <vector>

#include "engine/method/combine.hpp"
#include "engine/method/compiled_plan.hpp"
#include "model/friction/contact_field.hpp"
#include "tasks/workspace.hpp"

namespace cvtflow::tasks {

class FrictionSystem {
public:
    /// @param states, slopes slots for velocities and accelerations that tables may use, slot 0 included
    FrictionSystem(const Workspace& workspace, int states, int slopes);

    /// Memory of segments, after every change of the partition.
    void repartition(const Partition& partition);

    /// Power iterations begin anew.
    void restart() noexcept;
    /// The forces at hand become those of the step before.
    void turn_over() noexcept { std::swap(base_, base_before_); }

    // Bodies of tasks: each touches the columns of one segment only, and reads those of its two neighbours.

    /// Notes the contacts of a segment's links at the stage state of workspace.row, and all other forces there.
    void push(Workspace& workspace, const model::ContactDrift& drift, int segment) noexcept;
    /// One row of a table: combines the velocities, keeps them if the row says so, evaluates with lean times the difference between base and
    /// that of the step before added to base; adds weight times the tips' forces to impulses.
    void stage(const Workspace& workspace, const engine::PlanStep& row, double h, double lean, double weight, int segment) noexcept;
    /// The same for a result: velocities of the segment's links into a slot.
    void result(const Workspace& workspace, const engine::PlanStep& row, double h, int slot, int segment) noexcept;
    /// Begins an integration from the velocities in a state: takes them into slot 0 and forgets the impulses.
    void begin_from(const Workspace& workspace, const double* state, int segment) noexcept;
    /// Loads of a segment's links: of the normal forces, and the mean reaction of the tips' friction since begin_from().
    void react(Workspace& workspace, int segment) const noexcept;

    /// Largest eigenvalue of friction about rest, from a few power iterations on; everything must be at rest [1/s].
    [[nodiscard]] double spectral_radius(const Workspace& workspace, int iterations) noexcept;

    /// What outlasts a step: forces of the last one, and where power iterations have come to.
    void save(std::vector<double>& memory) const;
    void load(std::span<const double> memory) noexcept;

    [[nodiscard]] model::Columns& state(int slot) noexcept { return states_[static_cast<std::size_t>(slot)]; }
    [[nodiscard]] const model::Columns& state(int slot) const noexcept { return states_[static_cast<std::size_t>(slot)]; }

private:
    struct SegmentMemory {
        model::Columns window;         ///< velocities of the segment's links and their neighbours, in the columns that slots have them in
        std::vector<double> scratch;
    };

    [[nodiscard]] model::FrictionRange range_of(const Workspace& workspace, double time, const model::Columns& velocity, int segment) noexcept;
    const model::Columns& combine(const engine::PlanStep& row, double h, const Workspace& workspace, int segment) noexcept;
    void keep(const Workspace& workspace, const model::Columns& window, model::Columns& slot, int segment) noexcept;
    void repeat(const Workspace& workspace, model::Columns& field, int segment) noexcept;

    model::FrictionOperator friction_;
    model::ContactField field_;
    std::vector<model::Columns> states_, slopes_;
    model::Columns base_, base_before_, impulses_, mode_, image_;
    std::vector<model::LinkLoad> normal_loads_;   ///< [links]
    std::vector<const double*> state_views_, slope_views_;
    std::vector<SegmentMemory> segments_;
};

}  // namespace cvtflow::tasks
