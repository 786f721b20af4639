#pragma once
/// The friction of a step: velocities of all links under friction and constant accelerations, everything else frozen, as a small system of
/// ordinary differential equations that a table of stages integrates inside the step, by segments.
///
/// In single precision velocities count from those of the middle of the step, at which contacts and all other forces are taken in double
/// precision; so does whatever slides. What the stages add to a link's velocities is rounded to 6e-8 of itself.

#include <array>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "tasks/method/friction/kick_tables.hpp"
#include "tasks/method/friction/segment_columns.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// @tparam Number of stages: double or float
template <class Number>
class FrictionSystem {
public:
    explicit FrictionSystem(const Workspace& workspace);

    /// Memory of segments, after every change of the partition.
    void repartition(const Partition& partition);

    /// Power iterations begin anew.
    void restart() noexcept;
    /// The forces at hand become those of the step before.
    void turn_over() noexcept { std::swap(base_, base_before_); }

    // Bodies of tasks: each touches the columns of one segment only, and reads what its neighbours have handed over.

    /// Notes the contacts of a segment's links at the stage state of workspace.step.row, and all other forces there. Takes their velocities
    /// at the step's start into slot 0, forgets their impulses.
    void record(Workspace& workspace, const model::ContactDrift& drift, int segment) noexcept;
    /// One row of a chained table: evaluates at the velocities of its slot, with extrapolation times the difference between base and that
    /// of the step before added to base; adds weight times the tips' forces to impulses; combines the velocities of the row that follows.
    void stage(const Workspace& workspace, const KickRow& row, double h, double extrapolation, int segment) noexcept;
    /// Loads of a segment's links: of the normal forces, and the mean reaction of the tips' friction since record().
    void react(Workspace& workspace, int segment) const noexcept;
    /// Velocities of a segment's links after the last row, into a state. state [unknowns]
    void give(const Workspace& workspace, double* state, int segment) const noexcept;

    /// Largest eigenvalue of friction about rest, from a few power iterations on; everything must be at rest [1/s].
    [[nodiscard]] double spectral_radius(const Workspace& workspace, int iterations) noexcept;

    /// What outlasts a step: forces of the last one, and where power iterations have come to.
    void save(std::vector<double>& memory) const;
    void load(std::span<const double> memory);  ///< memory [what save() wrote]

private:
    using Columns = model::ColumnsOf<Number>;
    static constexpr bool relative = std::is_same_v<Number, float>;

    /// time [s]
    [[nodiscard]] model::FrictionRangeOf<Number> range_of(const Workspace& workspace, double time, const Columns& velocity,
                                                          int segment) noexcept;
    /// state [unknowns]
    void take(const Workspace& workspace, const double* state, int segment) noexcept;
    void make_columns();
    void move(Columns& field, bool grows);
    /// Calls visit(link, column) for all links, in order.
    template <class Visit>
    void for_links(const SegmentColumns& columns, const Visit& visit) const {
        for (int s = 0; s < columns.segments(); ++s) {
            for (int link = columns.segment(s).first; link < columns.segment(s).last; ++link) visit(link, link + columns.shift(s));
        }
    }

    model::FrictionOperator friction_;
    model::ContactFieldOf<Number> field_;
    SegmentColumns columns_, columns_before_;  ///< now, and before the borders moved
    int width_ = 0;                            ///< columns of all fields
    std::array<Columns, kick_state_slots> states_;
    std::array<SegmentEdges<Number>, kick_state_slots> edges_;  ///< of states_
    SegmentEdges<Number> contact_edges_, mode_edges_;
    std::vector<Number> row_;  ///< [links] room
    Columns result_, first_slope_, base_, base_before_, impulses_, mode_, image_;
    std::vector<model::LinkLoad> normal_loads_;       ///< [links]
    std::vector<model::LineVector<Number>> scratch_;  ///< of segments
};

}  // namespace cvtflow::tasks
