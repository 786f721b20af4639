#include "tasks/method/friction/sweep_leapfrog.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "tasks/step/step_method.hpp"

namespace cvtflow::tasks {

namespace {

/// Rows of velocities of a link that move the joint at one of its ends.
[[nodiscard]] std::vector<int> near_joint(const model::ChainLayout& at, model::End end) {
    const model::End other = end == model::End::rear ? model::End::front : model::End::rear;
    std::vector<int> rows{at.z(end), at.e(end), at.x(other, 0), at.y(other, 0)};
    for (int m = 0; m < at.lateral(); ++m) rows.insert(rows.end(), {at.x(end, m), at.y(end, m)});
    return rows;
}

}  // namespace

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

SegmentEdges::SegmentEdges(int rows) : SegmentEdges({std::vector<int>(at(rows)), std::vector<int>(at(rows))}) {
    for (std::vector<int>& each : rows_) std::iota(each.begin(), each.end(), 0);
}

SegmentEdges::SegmentEdges(const model::ChainLayout& at)
    : SegmentEdges({near_joint(at, model::End::rear), near_joint(at, model::End::front)}) {}

SegmentEdges::SegmentEdges(std::array<std::vector<int>, 2> rows) : rows_(std::move(rows)) {
    constexpr int line = model::FloatColumns::line;
    stride_ = (static_cast<int>(rows_[0].size()) + line - 1) / line * line;
}

void SegmentEdges::make_room(int segments) {
    if (packed_.size() < place(segments, 0)) packed_.resize(place(segments, 0), 0.0F);
}

void SegmentEdges::give(const SegmentColumns& columns, const model::FloatColumns& field, int segment) noexcept {
    constexpr int first = SegmentColumns::first;
    float* front = packed_.data() + place(segment, 0);
    float* back = packed_.data() + place(segment, 1);
    for (const int row : rows_[0]) *front++ = *field.at(row, first);
    for (const int row : rows_[1]) *back++ = *field.at(row, first + columns.segment(segment).size() - 1);
}

void SegmentEdges::take(const SegmentColumns& columns, model::FloatColumns& field, int segment) const noexcept {
    for (const GhostColumn& ghost : columns.ghosts(segment)) {
        const float* from = packed_.data() + place(ghost.owner, ghost.place);
        for (const int row : rows_[at(ghost.place)]) *field.at(row, ghost.column) = *from++;
    }
}

SegmentFields::SegmentFields(const Workspace& w, const model::FrictionOperator& friction, std::vector<int> rows,
                             std::vector<std::size_t> outlasting, std::vector<SegmentEdges> edges)
    : friction_(friction), rows_(std::move(rows)), outlasting_(std::move(outlasting)), edges_(std::move(edges)) {
    moving_.resize(outlasting_.size() * at(rows_[outlasting_.front()] * w.layout().links));
    columns_.lay_out(w.partition);
    make_room();
}

SegmentFields::Fields SegmentFields::make_fields(int width) const {
    const int size = friction_.chain().layout().link_size();
    Fields fields{width, model::ContactField(friction_.chain()), {size, width}, {size, width}, {3 * model::tips_per_link, width}, {}, {}};
    fields.contacts.make_columns(width);
    for (const int rows : rows_) fields.of.emplace_back(rows, width);
    fields.scratch.resize(at(friction_.scratch_size(width)), 0.0F);
    return fields;
}

/// Fields and edges for all segments. Widths are whole lines, so that fields stay large enough when borders move a little.
void SegmentFields::make_room() {
    constexpr int line = Columns::line;
    const int segments = columns_.segments();
    for (int s = 0; s < segments; ++s) {
        const int width = (columns_.count(s) + line - 1) / line * line;
        if (at(s) == fields_.size()) {
            fields_.push_back(make_fields(width));
        } else if ((*this)[s].width < width) {
            (*this)[s] = make_fields(width);
        }
    }
    for (SegmentEdges& edges : edges_) edges.make_room(segments);
}

/// Keeps all fields that outlast a step.
void SegmentFields::repartition(const Partition& partition) {
    float* room = moving_.data();
    for (const std::size_t field : outlasting_) for_numbers(*this, field, [&](float& number) { *room++ = number; });
    columns_.lay_out(partition);
    make_room();
    room = moving_.data();
    for (const std::size_t field : outlasting_) set(field, [&] { return *room++; });
}

/// Ghost columns too: what their owners have.
template <class Next>
void SegmentFields::set(std::size_t field, const Next& next) {
    for_numbers(*this, field, [&](float& number) { number = next(); });
    for (int s = 0; s < columns_.segments(); ++s) {
        for (const GhostColumn& ghost : columns_.ghosts(s)) {
            const int from = ghost.place == 0 ? SegmentColumns::first : columns_.segment(ghost.owner).size();
            for (int row = 0; row < rows_[field]; ++row)
                *(*this)[s].of[field].at(row, ghost.column) = *(*this)[ghost.owner].of[field].at(row, from);
        }
    }
}

std::size_t SegmentFields::bytes() const noexcept {
    std::size_t bytes = 0;
    for (const SegmentEdges& each : edges_) bytes += each.bytes();
    for (const Fields& f : fields_) {
        bytes += f.contacts.bytes() + f.start.bytes() + f.result.bytes() + f.mean_tip_forces.bytes() + f.scratch.size() * sizeof(float);
        for (const Columns& each : f.of) bytes += each.bytes();
    }
    return bytes;
}

void SegmentFields::clear(std::size_t field) noexcept {
    set(field, [] { return 0.0F; });
}

void SegmentFields::visit(std::size_t field, std::string_view name, engine::Archive& archive) {
    const std::span numbers(moving_.data(), at(rows_[field] * friction_.chain().layout().links));
    float* next = numbers.data();
    if (!archive.reads()) for_numbers(*this, field, [&](float number) { *next++ = number + 0.0F; });  // no zero below 0: segments decide
    archive(name, numbers);
    if (archive.reads()) set(field, [&] { return *next++; });
}

}  // namespace cvtflow::tasks
