#pragma once
/// Which column of its segment's fields a link has, and what neighbouring segments read of each other.
///
/// Columns of all links side by side would make segments share cache lines, and what a processor fetches ahead, a row's lines up to the
/// next segment's, would be taken from the processor that writes them at every stage. So every segment has fields of its own, ghost columns
/// included, and what its neighbours need is handed over in one piece.

#include <span>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "tasks/step/workspace.hpp"

namespace cvtflow::tasks {

/// A ghost column of a segment, and the segment that holds its link.
struct GhostColumn {
    int column;
    int owner;  ///< segment
    int place;  ///< among the columns that the owner hands over: 0, its first one, or 1, its last one
};

class SegmentColumns {
public:
    /// Column of every segment's first link: there a cache line begins.
    static constexpr int first = 1;

    void lay_out(const Partition& partition);

    [[nodiscard]] int segments() const noexcept { return static_cast<int>(segments_.size()); }
    [[nodiscard]] const Segment& segment(int number) const noexcept { return segments_[static_cast<std::size_t>(number)]; }
    /// Columns of a segment's fields, ghosts included, and those before the first link.
    [[nodiscard]] int count(int number) const noexcept { return first + segment(number).size() + 1; }
    /// Offset from the number of a segment's link to its column.
    [[nodiscard]] int shift(int number) const noexcept { return first - segment(number).first; }
    /// One before its links and one behind them.
    [[nodiscard]] std::span<const GhostColumn> ghosts(int segment) const noexcept {
        return std::span(ghosts_).subspan(static_cast<std::size_t>(2 * segment), 2);
    }

private:
    std::vector<Segment> segments_;
    std::vector<GhostColumn> ghosts_;  ///< [segments][2]
};

/// Data of one field that segments exchange: its first and its last column, packed.
template <class Number>
class SegmentEdges {
public:
    SegmentEdges() = default;
    explicit SegmentEdges(int rows);

    /// Makes room for `segments` segments. Allocates only if there were fewer before.
    void make_room(int segments);
    [[nodiscard]] std::size_t bytes() const noexcept { return packed_.size() * sizeof(Number); }
    /// Copies a segment's first and last column of its field.
    void give(const SegmentColumns& columns, const model::ColumnsOf<Number>& field, int segment) noexcept;
    /// Fills the ghost columns of a segment's field with what their owners gave.
    void take(const SegmentColumns& columns, model::ColumnsOf<Number>& field, int segment) const noexcept;

private:
    [[nodiscard]] std::size_t place(int segment, int number) const noexcept {
        return static_cast<std::size_t>((2 * segment + number) * stride_);
    }

    int rows_ = 0, stride_ = 0;
    model::LineVector<Number> packed_;  ///< [segments][2][stride]
};

}  // namespace cvtflow::tasks
