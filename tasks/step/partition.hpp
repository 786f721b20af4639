#pragma once
/// Contiguous segments of links: the unit of work of the task graph.

#include <algorithm>
#include <span>
#include <vector>

#include "model/variator/variator.hpp"

namespace cvtflow::tasks {

/// Links [first, last).
struct Segment {
    int first, last;
    [[nodiscard]] int size() const noexcept { return last - first; }
    bool operator==(const Segment&) const = default;
};

class Partition {
public:
    /// Segments begin at multiples of this number of links for kernels with `lanes` links side by side, as do vectors and sums of
    /// reactions. With vectors of eight lanes half a vector is good enough: two threads need five and six of them either way, and costs per
    /// link are better balanced (40 and 44 links instead of 48 and 36).
    [[nodiscard]] static int grain(int lanes) noexcept { return std::min(lanes, model::links_per_sum); }

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
