#pragma once
/// Columns of links by segments, and what segments hand over. Columns of fields that outlast a step move with the borders of segments.
///
/// A segment needs the links beside it, its ghosts:
///
///     segment s          … 13 14 15 [16]          [16]: the first link of s + 1
///     segment s + 1            [15] 16 17 18 …    [15]: the last link of s
///
/// Their coordinates in the middle of a step: a GhostLink advances by itself, by velocities that its owner has handed over, to its owner's
/// bits. Their velocities after each pass: those that the joint between both depends on are handed over (SegmentEdges). So no segment reads
/// another's state, and no cache line has two writers.

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "model/contact/friction_operator.hpp"
#include "tasks/step/assembly/segment_tasks.hpp"

namespace cvtflow::tasks {

/// A ghost column of a segment, and the segment that holds its link.
struct GhostColumn {
    int column;
    int owner;  ///< segment
    int place;  ///< place among the columns that the owner hands over: 0, its first one, or 1, its last one
};

/// Columns of links in the fields of their segment, and the columns that neighbouring segments read.
///
/// With the columns of all links side by side, segments would share cache lines, and prefetching would steal lines from the segment that
/// writes them at every stage. So every segment has separate fields, ghost columns included, and what its neighbours need is handed over
/// in one piece.
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
class SegmentEdges {
public:
    /// @param rows of fields: all of them
    explicit SegmentEdges(int rows);
    /// Rows of velocities of links that the joints between two segments depend on.
    explicit SegmentEdges(const model::ChainLayout& at);

    /// Makes room for `segments` segments. Allocates only if there were fewer before.
    void make_room(int segments);
    [[nodiscard]] std::size_t bytes() const noexcept { return packed_.size() * sizeof(float); }
    /// Copies a segment's first and last column of its field.
    void give(const SegmentColumns& columns, const model::FloatColumns& field, int segment) noexcept;
    /// Fills the ghost columns of a segment's field with what their owners gave.
    void take(const SegmentColumns& columns, model::FloatColumns& field, int segment) const noexcept;

private:
    [[nodiscard]] std::size_t place(int segment, int number) const noexcept {
        return static_cast<std::size_t>((2 * segment + number) * stride_);
    }

    explicit SegmentEdges(std::array<std::vector<int>, 2> rows);

    std::array<std::vector<int>, 2> rows_;  ///< rows of the first column, and of the last one
    int stride_ = 0;
    model::LineVector<float> packed_;  ///< [segments][2][stride]
};

/// Data that the tasks of segments write and read: contacts, fields of numbers of links by component, scratch. Fields that outlast a step
/// move with the borders of segments.
class SegmentFields {
public:
    using Columns = model::FloatColumns;

    /// Data of one segment. Column = link + shift of the segment.
    struct Fields {
        int width;  ///< columns
        model::ContactField contacts;
        Columns start, result;    ///< velocities at the step's start and at its end
        Columns mean_tip_forces;  ///< friction of the tips
        std::vector<Columns> of;  ///< [field] further ones of the method
        model::LineVector<float> scratch;
    };

    /// @param rows of each further field   @param outlasting fields that outlast a step, with equally many rows
    /// @param edges what segments hand over
    SegmentFields(const Workspace& workspace, const model::FrictionOperator& friction, std::vector<int> rows,
                  std::vector<std::size_t> outlasting, std::vector<SegmentEdges> edges);

    /// Memory of segments, after every change of the partition.
    void repartition(const Partition& partition);
    [[nodiscard]] const SegmentColumns& columns() const noexcept { return columns_; }
    [[nodiscard]] Fields& operator[](int segment) noexcept { return fields_[at(segment)]; }
    [[nodiscard]] const Fields& operator[](int segment) const noexcept { return fields_[at(segment)]; }
    /// Memory that a step touches [B]: no room for what borders move through, nothing that is computed on demand.
    [[nodiscard]] std::size_t bytes() const noexcept;

    /// Hands over a segment's part of a field to its neighbours.
    void give(std::size_t edge, const Columns& field, int segment) noexcept { edges_[edge].give(columns_, field, segment); }
    /// Takes over what its neighbours have given.
    void take(std::size_t edge, Columns& field, int segment) const noexcept { edges_[edge].take(columns_, field, segment); }

    /// The numbers of a field become zero, of all links.
    void clear(std::size_t field) noexcept;
    /// The numbers of a field, rows of all links one after the other.
    void visit(std::size_t field, std::string_view name, engine::Archive& archive);

private:
    [[nodiscard]] Fields make_fields(int width) const;
    void make_room();
    /// Sets the numbers of a field to what next() returns, rows of all links one after the other.
    template <class Next>
    void set(std::size_t field, const Next& next);
    /// Calls visit(number) for all numbers of a field, rows of all links one after the other.
    template <class Self, class Visit>
    static void for_numbers(Self& self, std::size_t field, const Visit& visit) {
        for (int row = 0; row < self.rows_[field]; ++row)
            for (int s = 0; s < self.columns_.segments(); ++s)
                for (int link = 0; link < self.columns_.segment(s).size(); ++link)
                    visit(*self[s].of[field].at(row, SegmentColumns::first + link));
    }

    const model::FrictionOperator& friction_;
    std::vector<int> rows_;                ///< [field] of further fields
    std::vector<std::size_t> outlasting_;  ///< fields
    SegmentColumns columns_;
    std::vector<Fields> fields_;       ///< [segment], or more
    std::vector<SegmentEdges> edges_;  ///< [edge]
    std::vector<float> moving_;        ///< [outlasting][rows][links] room for what borders move through
};

}  // namespace cvtflow::tasks
