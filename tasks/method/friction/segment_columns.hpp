#pragma once
/// Where the links of segments lie in fields of columns, and what neighbouring segments read of each other.
///
/// Columns of all links side by side would make segments share cache lines: a row's border line for every row, on its way between two
/// processors at every stage. So every segment has columns of its own, ghost columns included, and what its neighbours need is handed over
/// in one piece.

#include <span>
#include <vector>

#include "model/contact/contact_field.hpp"
#include "tasks/step/partition.hpp"

namespace cvtflow::tasks {

/// A ghost column of a segment, and who holds the link that it repeats.
struct GhostColumn {
    int column;
    int owner;  ///< segment
    int place;  ///< among the columns that the owner hands over: its first ones, then its last ones from the end
};

class SegmentColumns {
public:
    /// @param halo ghost columns on each side
    /// @param line numbers of a cache line
    SegmentColumns(int halo, int line) : halo_(halo), line_(line) {}

    /// Every segment's first link begins a cache line; between segments lies a line that nobody writes.
    void lay_out(const Partition& partition);

    /// Columns of all segments, ghosts included, and one before them.
    [[nodiscard]] int count() const noexcept { return count_; }
    [[nodiscard]] int halo() const noexcept { return halo_; }
    [[nodiscard]] int segments() const noexcept { return static_cast<int>(segments_.size()); }
    [[nodiscard]] const Segment& segment(int number) const noexcept { return segments_[static_cast<std::size_t>(number)]; }
    /// Column of a segment's first link.
    [[nodiscard]] int first(int segment) const noexcept { return first_[static_cast<std::size_t>(segment)]; }
    /// What is added to the number of a segment's link for its column.
    [[nodiscard]] int shift(int number) const noexcept { return first(number) - segment(number).first; }
    [[nodiscard]] std::span<const GhostColumn> ghosts(int segment) const noexcept {
        return std::span(ghosts_).subspan(static_cast<std::size_t>(2 * halo_ * segment), static_cast<std::size_t>(2 * halo_));
    }

private:
    void find_ghosts(int links);

    int halo_, line_, count_ = 0;
    std::vector<Segment> segments_;
    std::vector<int> first_;
    std::vector<GhostColumn> ghosts_;  ///< [segments][2 halo]
};

/// What segments hand over of one field: its first and its last columns, packed.
template <class Number>
class SegmentEdges {
public:
    SegmentEdges() = default;
    SegmentEdges(int rows, int halo);

    /// Room for so many segments. Allocates only if there were never so many.
    void make_room(int segments);
    /// Copies a segment's first and last columns of a field.
    void give(const SegmentColumns& columns, const model::ColumnsOf<Number>& field, int segment) noexcept;
    /// Fills a segment's ghost columns with what their owners gave.
    void take(const SegmentColumns& columns, model::ColumnsOf<Number>& field, int segment) const noexcept;

private:
    [[nodiscard]] std::size_t place(int segment, int number) const noexcept {
        return static_cast<std::size_t>((segment * 2 * halo_ + number) * stride_);
    }

    int rows_ = 0, halo_ = 0, stride_ = 0;
    model::LineVector<Number> packed_;  ///< [segments][2 halo][stride]
};

}  // namespace cvtflow::tasks
