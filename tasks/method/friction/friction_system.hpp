#pragma once
/// The friction of a step: velocities of all links under friction and constant accelerations, everything else frozen, as a small system of
/// ordinary differential equations that a table of stages integrates inside the step, by segments.

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "tasks/method/friction/kick_tables.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

class FrictionSystem {
public:
    explicit FrictionSystem(const Workspace& workspace);

    /// Memory of segments, after every change of the partition.
    void repartition(const Partition& partition);

    /// Power iterations begin anew.
    void restart() noexcept;
    /// The forces at hand become those of the step before.
    void turn_over() noexcept { std::swap(base_, base_before_); }

    // Bodies of tasks: each touches the columns of one segment only, and reads those of its two neighbours.

    /// Notes the contacts of a segment's links at the stage state of workspace.step.row, and all other forces there.
    void push(Workspace& workspace, const model::ContactDrift& drift, int segment) noexcept;
    /// One row of a chained table: evaluates at the velocities of its slot, with lean times the difference between base and that of the
    /// step before added to base; adds weight times the tips' forces to impulses; combines the velocities of the row that follows.
    void stage(const Workspace& workspace, const KickRow& row, double h, double lean, int segment) noexcept;
    /// Begins an integration from the velocities in a state: takes them into slot 0 and forgets the impulses. state [unknowns]
    void begin_from(const Workspace& workspace, const double* state, int segment) noexcept;
    /// Loads of a segment's links: of the normal forces, and the mean reaction of the tips' friction since begin_from().
    void react(Workspace& workspace, int segment) const noexcept;

    /// Largest eigenvalue of friction about rest, from a few power iterations on; everything must be at rest [1/s].
    [[nodiscard]] double spectral_radius(const Workspace& workspace, int iterations) noexcept;

    /// What outlasts a step: forces of the last one, and where power iterations have come to.
    void save(std::vector<double>& memory) const;
    void load(std::span<const double> memory);  ///< memory [what save() wrote]

    /// Velocities after the last row.
    [[nodiscard]] const model::Columns& result() const noexcept { return result_; }

private:
    /// time [s]
    [[nodiscard]] model::FrictionRange range_of(const Workspace& workspace, double time, const model::Columns& velocity,
                                                int segment) noexcept;
    void repeat(const Workspace& workspace, model::Columns& field, int segment) noexcept;

    model::FrictionOperator friction_;
    model::ContactField field_;
    std::array<model::Columns, kick_state_slots> states_;
    model::Columns result_, first_slope_, base_, base_before_, impulses_, mode_, image_;
    std::vector<model::LinkLoad> normal_loads_;       ///< [links]
    std::vector<model::LineVector<double>> scratch_;  ///< of segments
};

}  // namespace cvtflow::tasks
