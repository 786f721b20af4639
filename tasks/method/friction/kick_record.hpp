#pragma once
/// What leapfrogs do by segments before and after friction has acted inside a step, whatever solves for it: contacts and all other forces
/// are recorded in the middle of the step; loads, velocities and coordinates are given back at its end.

#include <vector>

#include "model/contact/contact_field.hpp"
#include "tasks/method/friction/segment_columns.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// Columns of one segment that a record fills. @tparam Number of the velocities: in single precision they count from those of the record
template <class Number>
struct KickColumns {
    model::ContactFieldOf<Number>& contacts;
    model::ColumnsOf<Number>& frictionless;  ///< accelerations by everything but friction
    model::ColumnsOf<Number>& start;         ///< velocities at the step's start
    model::ColumnsOf<Number>& impulses;      ///< mean forces of the tips' friction, zero so far
};

/// Contacts of a segment's links at the stage state of workspace.step.row, and all other forces there. normal_loads [links]
template <class Number>
void record_kick(Workspace& workspace, const model::FrictionOperator& friction, const model::ContactDrift& drift,
                 const SegmentColumns& columns, int segment, const KickColumns<Number>& to, std::vector<model::LinkLoad>& normal_loads);

/// Loads of a segment's links and their sums: of the normal forces, and the mean reaction of the tips' friction. normal_loads [links]
template <class Number>
void react_to_kick(Workspace& workspace, const SegmentColumns& columns, int segment, const model::ContactFieldOf<Number>& contacts,
                   const model::ColumnsOf<Number>& impulses, const std::vector<model::LinkLoad>& normal_loads) noexcept;

/// Velocities of a segment's links into the state at the step's end, and the coordinates that follow from them.
template <class Number>
void end_kick(Workspace& workspace, const SegmentColumns& columns, int segment, const model::ColumnsOf<Number>& velocities) noexcept;

/// A segment and those that hold the links beside it.
[[nodiscard]] std::vector<int> near_segments(const Workspace& workspace, int segment);

}  // namespace cvtflow::tasks
