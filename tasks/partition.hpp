#pragma once
/// Contiguous segments of links: the unit of work of the task graph.

#include <span>
#include <vector>

namespace cvtflow::tasks {

/// Links [first, last).
struct Segment {
    int first, last;
    [[nodiscard]] int size() const noexcept { return last - first; }
    bool operator==(const Segment&) const = default;
};

class Partition {
public:
    /// `segments` runs of equal length, up to `grain` links; they begin at multiples of it, as long as there are enough of those.
    /// Throws std::invalid_argument unless 1 ≤ segments ≤ links.
    static Partition equal(int links, int segments, int grain = 1);

    /// Segments between the given cuts: 0 = cuts[0] < cuts[1] < … = number of links. Throws std::invalid_argument otherwise.
    static Partition at(const std::vector<int>& cuts);

    [[nodiscard]] std::span<const Segment> segments() const noexcept { return segments_; }
    [[nodiscard]] const Segment& operator[](int segment) const noexcept { return segments_[static_cast<std::size_t>(segment)]; }
    [[nodiscard]] int size() const noexcept { return static_cast<int>(segments_.size()); }

private:
    std::vector<Segment> segments_;
};

}  // namespace cvtflow::tasks
