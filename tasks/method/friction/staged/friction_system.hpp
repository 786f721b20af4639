#pragma once
/// The friction of a step: velocities of all links under friction and constant accelerations, everything else frozen, as a small system of
/// ordinary differential equations that a table of stages integrates inside the step, by segments.
///
/// In single precision velocities count from those of the middle of the step, at which contacts and all other forces are taken in double
/// precision; so does whatever slides. What the stages add to a link's velocities is rounded to 6e-8 of itself.

#include <array>
#include <span>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "tasks/method/friction/segment_columns.hpp"
#include "tasks/method/friction/staged/kick_tables.hpp"
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
    void turn_over() noexcept { now_ = 1 - now_; }

    // Bodies of tasks: each touches the columns of one segment only, and reads what its neighbours have handed over.

    /// Notes the contacts of a segment's links at the stage state of workspace.step.row, and all other forces there. Takes their velocities
    /// at the step's start into slot 0, forgets their impulses.
    void record(Workspace& workspace, const model::ContactDrift& drift, int segment) noexcept;
    /// One row of a chained table: evaluates at the velocities of its slot, with extrapolation times the difference between base and that
    /// of the step before added to base; adds weight times the tips' forces to impulses; combines the velocities of the row that follows.
    void stage(const Workspace& workspace, const KickRow& row, double h, double extrapolation, int segment) noexcept;
    /// Loads of a segment's links since record(); their state at the step's end by the velocities after the last row.
    void finish(Workspace& workspace, int segment) const noexcept;

    /// Largest eigenvalue of friction about rest, from a few power iterations on; everything must be at rest [1/s].
    [[nodiscard]] double spectral_radius(const Workspace& workspace, int iterations) noexcept;

    /// Memory that a step touches [B], no room for what borders move through.
    [[nodiscard]] std::size_t bytes() const noexcept;

    /// Memory between steps: forces of the last step, and the vectors of power iterations.
    void save(std::vector<double>& memory) const;
    void load(std::span<const double> memory);  ///< memory [what save() wrote]

private:
    using Columns = model::ColumnsOf<Number>;

    /// What a segment's tasks write and read. Column = link + shift of the segment.
    struct Fields {
        Fields(const model::FrictionOperator& friction, int columns);

        int width;  ///< columns
        model::ContactFieldOf<Number> contacts;
        std::array<Columns, kick_state_slots> states;
        std::array<Columns, 2> base;  ///< accelerations by everything but friction, of this step and of the one before: see now_
        Columns result, first_slope, impulses, mode, image;
        model::LineVector<Number> scratch;
    };

    /// time [s]
    [[nodiscard]] model::FrictionRangeOf<Number> range_of(const Workspace& workspace, double time, const Columns& velocity,
                                                          int segment) noexcept;
    void make_room();
    /// The columns that outlast a step; checkpoints hold the first two.
    template <class Some>
    [[nodiscard]] auto kept(Some& fields) const noexcept {
        return std::array{&fields.base[now_], &fields.mode, &fields.base[1 - now_]};
    }
    static constexpr std::size_t kept_fields = 3, saved_fields = 2;
    [[nodiscard]] Fields& fields(int segment) noexcept { return fields_[static_cast<std::size_t>(segment)]; }
    [[nodiscard]] const Fields& fields(int segment) const noexcept { return fields_[static_cast<std::size_t>(segment)]; }
    /// Calls visit(fields, link, column) for all links of a system, in order.
    template <class System, class Visit>
    static void for_links(System& system, const Visit& visit) {
        for (int s = 0; s < system.columns_.segments(); ++s) {
            const Segment& own = system.columns_.segment(s);
            for (int link = own.first; link < own.last; ++link) visit(system.fields(s), link, link + system.columns_.shift(s));
        }
    }

    model::FrictionOperator friction_;
    SegmentColumns columns_;
    std::vector<Fields> fields_;                                ///< [segment], or more
    std::size_t now_ = 0;                                       ///< which of two bases is this step's
    std::array<SegmentEdges<Number>, kick_state_slots> edges_;  ///< of states
    SegmentEdges<Number> contact_edges_, mode_edges_;
    std::vector<Number> moving_;                 ///< [kept][rows][links] room for what borders move through
    std::vector<model::LinkLoad> normal_loads_;  ///< [links]
};

}  // namespace cvtflow::tasks
