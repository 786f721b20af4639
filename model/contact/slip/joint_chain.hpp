#pragma once
/// The joints of a chain as a ring of symmetric positive definite equations, stretches of it side by side in lanes: what JointReduction
/// works on. It knows no contacts.

#include <vector>

#include "model/basis/aligned.hpp"

namespace cvtflow::model {

/// Links of a group, side by side in lanes.
inline constexpr int slip_lanes = 16;

/// Rows of slip_lanes numbers each, one lane per link, on cache lines of their own.
template <class Number>
class RowsOf {
public:
    RowsOf() = default;
    explicit RowsOf(int rows) : memory_(static_cast<std::size_t>(rows * slip_lanes), Number(0)) {}
    [[nodiscard]] Number* at(int row) noexcept { return memory_.data() + row * slip_lanes; }
    [[nodiscard]] const Number* at(int row) const noexcept { return memory_.data() + row * slip_lanes; }

private:
    LineVector<Number> memory_;
};
using LaneRows = RowsOf<double>;
using FloatRows = RowsOf<float>;

/// Which links lie side by side. Stretches are as long as possible alike; shorter ones have no link in group 0, where their lane idles.
class SlipStretches {
public:
    explicit SlipStretches(int links) noexcept
        : links_(links), count_(links < slip_lanes ? links : slip_lanes), length_((links + count_ - 1) / count_) {}

    struct Place {
        int group, lane;
    };
    /// Stretches, and links of the longest of them, which is the number of groups.
    [[nodiscard]] int count() const noexcept { return count_; }
    [[nodiscard]] int length() const noexcept { return length_; }
    [[nodiscard]] bool idle(Place p) const noexcept { return p.lane >= count_ || p.group < first_group(p.lane); }
    /// The group of a stretch's first link: 0 or 1.
    [[nodiscard]] int first_group(int lane) const noexcept { return length_ - (first_link(lane + 1) - first_link(lane)); }
    /// The link at a place; of one that idles: some link nearby.
    [[nodiscard]] int link(Place p) const noexcept {
        const int lane = p.lane < count_ ? p.lane : count_ - 1;
        return first_link(lane) + (idle({p.group, lane}) ? 0 : p.group - first_group(lane));
    }
    /// Where the neighbours of the link at a place are.
    [[nodiscard]] Place before(Place p) const noexcept {
        if (p.group > 0 && p.group > first_group(p.lane)) return {p.group - 1, p.lane};
        return {length_ - 1, p.lane == 0 ? count_ - 1 : p.lane - 1};
    }
    [[nodiscard]] Place after(Place p) const noexcept {
        if (p.group + 1 < length_) return {p.group + 1, p.lane};
        const int lane = p.lane + 1 == count_ ? 0 : p.lane + 1;
        return {first_group(lane), lane};
    }

private:
    [[nodiscard]] int first_link(int lane) const noexcept { return links_ * lane / count_; }
    int links_, count_, length_;
};

/// Entry (row, column ≤ row) of a lower triangle stored row by row.
[[nodiscard]] constexpr int triangle(int row, int column) noexcept { return row * (row + 1) / 2 + column; }

/// What two neighbouring joints have of each other, a link or a row of links between them: rows of floats.
struct SlipElement {
    int size;  ///< unknowns of a joint
    /// First rows of blocks [size][size]: of both ends, of which what is above the diagonal does not count, and of the front joint on the
    /// rear one.
    [[nodiscard]] constexpr int rear() const noexcept { return 0; }
    [[nodiscard]] constexpr int across() const noexcept { return size * size; }
    [[nodiscard]] constexpr int front() const noexcept { return 2 * size * size; }
    /// Of right-hand sides [size].
    [[nodiscard]] constexpr int rear_side() const noexcept { return 3 * size * size; }
    [[nodiscard]] constexpr int front_side() const noexcept { return rear_side() + size; }
    [[nodiscard]] constexpr int count() const noexcept { return front_side() + size; }
};

/// What is kept of a joint that has been eliminated between two others: M = L D Lᵀ, L⁻¹ [on the joint before | on the next | right-hand
/// side].
struct SlipStep {
    int size;
    [[nodiscard]] constexpr int factor(int row, int column) const noexcept {
        return triangle(row, column);
    }  ///< L, and D⁻¹ on its diagonal
    [[nodiscard]] constexpr int panel(int row, int column) const noexcept { return triangle(size, 0) + (2 * size + 1) * row + column; }
    [[nodiscard]] constexpr int count() const noexcept { return panel(size, 0); }
};

/// The joints of the whole chain.
struct SlipChain {
    SlipChain(const SlipStretches& stretches, int size);
    /// Times that every other joint between stretches is eliminated, until one is left.
    [[nodiscard]] int levels() const noexcept { return static_cast<int>(counts.size()) - 1; }

    SlipStretches stretches;
    int size;                                ///< unknowns of a joint
    std::vector<const FloatRows*> elements;  ///< SlipElement of every group, while the joints are solved for
    std::vector<int> counts;                 ///< joints between stretches that are left [level]
    std::vector<FloatRows> steps;            ///< [joint inside a stretch - 1, then level] SlipStep
    FloatRows left, right;                   ///< SlipElement at work
    FloatRows scaled;                        ///< D⁻¹ times the panel at work
    FloatRows sides;                         ///< [joint][size]: right-hand sides of joints
    FloatRows unknowns;  ///< x [joint][size]; joints 0 … length of every stretch, the last being the next stretch's first
    FloatRows ends;      ///< x at stretches' beginnings, level by level [size]
};

}  // namespace cvtflow::model
