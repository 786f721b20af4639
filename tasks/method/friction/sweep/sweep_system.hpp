#pragma once
/// The friction of a step as forces that implicit sweeps find (model/contact/sweep_step.hpp), by segments. Both neighbours of a border
/// compute its joint, from what they have handed over; so the same bits come out for all segments.

#include <array>
#include <span>
#include <vector>

#include "model/contact/sweep_step.hpp"
#include "tasks/method/friction/segment_columns.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// @tparam Number of velocities inside the step: double or float
template <class Number>
class SweepSystem {
public:
    explicit SweepSystem(const Workspace& workspace);

    /// Memory of segments, after every change of the partition.
    void repartition(const Partition& partition);
    /// There was no step before: no contact has a force.
    void restart() noexcept;
    /// The forces at hand become those of the step before.
    void turn_over() noexcept { now_ = 1 - now_; }
    /// What follows is one step. @param nominal its length if nothing had cut it short [s]
    void begin(double step, double nominal) noexcept;
    /// It has been taken.
    void end() noexcept { losses_ = Losses::to_be_found; }

    // Bodies of tasks: each touches the columns of one segment only, and reads what its neighbours have handed over.

    /// Contacts of a segment's links at the stage state of workspace.step.row, and all other forces there.
    void record(Workspace& workspace, const model::ContactDrift& drift, int segment) noexcept;
    /// Pass `number` of the step, from 0 on. @param ahead FrictionSweepOf::ahead
    void sweep(const Workspace& workspace, model::SweepPart part, double ahead, int number, int segment) noexcept;
    /// Loads of a segment's links and their state at the step's end, after the closing pass.
    void finish(Workspace& workspace, int segment) const noexcept;

    /// Losses by friction in the accounts of an observe cycle become what the forces of the last step have done; while all is at rest.
    void book(Workspace& workspace) noexcept;

    /// Memory that a step touches [B]: no room for what borders move through, nothing that is computed on demand.
    [[nodiscard]] std::size_t bytes() const noexcept;

    /// What outlasts a step: its forces, and their losses.
    void save(std::vector<double>& memory) const;
    void load(std::span<const double> memory);  ///< memory [what save() wrote]

private:
    using Columns = model::ColumnsOf<Number>;
    enum class Losses { none, to_be_found, known };

    /// What a segment's tasks write and read. Column = link + shift of the segment.
    struct Fields {
        Fields(const model::FrictionOperator& friction, int columns);

        int width;  ///< columns
        model::ContactFieldOf<Number> contacts;
        Columns base, start, velocity, result, impulses;
        mutable Columns mean;         ///< velocity of the step, when its losses are found
        std::array<Columns, 2> kept;  ///< of this step and of the one before: see now_
        model::LineVector<Number> scratch;
    };

    [[nodiscard]] model::SweepRows rows() const noexcept;
    void make_room();
    void find_losses() const noexcept;
    [[nodiscard]] Fields& fields(int segment) noexcept { return fields_[static_cast<std::size_t>(segment)]; }
    [[nodiscard]] const Fields& fields(int segment) const noexcept { return fields_[static_cast<std::size_t>(segment)]; }
    /// Calls visit(number) for one of the kept columns, rows of all links one after the other.
    template <class System, class Visit>
    static void for_kept(System& system, std::size_t which, const Visit& visit);

    model::FrictionOperator friction_;
    model::SweepResponses<Number> responses_;
    SegmentColumns columns_;
    std::vector<Fields> fields_;  ///< [segment], or more
    std::size_t now_ = 0;         ///< which of two columns are this step's
    SegmentEdges<Number> contact_edges_, kept_edges_;
    std::array<SegmentEdges<Number>, 2> velocity_edges_;  ///< after passes of even and of odd number
    std::vector<Number> moving_;                          ///< [2] room for what borders move through
    std::vector<model::LinkLoad> normal_loads_;           ///< [links]
    // Computed on demand: for an observation, a checkpoint, or borders that move.
    mutable Losses losses_ = Losses::none;
    mutable SegmentEdges<Number> mean_edges_;
    mutable std::vector<model::FrictionPowers> powers_;  ///< [links] of the last step
};

}  // namespace cvtflow::tasks
