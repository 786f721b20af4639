#include "tasks/method/friction/segment_columns.hpp"

#include <algorithm>

namespace cvtflow::tasks {

void SegmentColumns::lay_out(const Partition& partition) {
    segments_.assign(partition.segments().begin(), partition.segments().end());
    const int links = segments_.back().last;
    const auto owner_of = [&](int link) {
        const auto found = std::find_if(segments_.begin(), segments_.end(), [=](const Segment& each) { return link < each.last; });
        return static_cast<int>(found - segments_.begin());
    };
    ghosts_.clear();
    for (int s = 0; s < segments(); ++s) {
        ghosts_.push_back({first - 1, owner_of((segment(s).first - 1 + links) % links), 1});
        ghosts_.push_back({first + segment(s).size(), owner_of(segment(s).last % links), 0});
    }
}

template <class Number>
SegmentEdges<Number>::SegmentEdges(int rows) : rows_(rows) {
    constexpr int line = model::ColumnsOf<Number>::line;
    stride_ = (rows + line - 1) / line * line;
}

template <class Number>
void SegmentEdges<Number>::make_room(int segments) {
    if (packed_.size() < place(segments, 0)) packed_.resize(place(segments, 0), Number(0));
}

template <class Number>
void SegmentEdges<Number>::give(const SegmentColumns& columns, const model::ColumnsOf<Number>& field, int segment) noexcept {
    constexpr int first = SegmentColumns::first;
    Number* front = packed_.data() + place(segment, 0);
    Number* back = packed_.data() + place(segment, 1);
    for (int row = 0; row < rows_; ++row) {
        front[row] = *field.at(row, first);
        back[row] = *field.at(row, first + columns.segment(segment).size() - 1);
    }
}

template <class Number>
void SegmentEdges<Number>::take(const SegmentColumns& columns, model::ColumnsOf<Number>& field, int segment) const noexcept {
    for (const GhostColumn& ghost : columns.ghosts(segment)) {
        const Number* from = packed_.data() + place(ghost.owner, ghost.place);
        for (int row = 0; row < rows_; ++row) *field.at(row, ghost.column) = from[row];
    }
}

template class SegmentEdges<double>;
template class SegmentEdges<float>;

}  // namespace cvtflow::tasks
