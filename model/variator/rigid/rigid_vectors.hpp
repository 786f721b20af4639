#pragma once
/// Plane vectors of pins side by side, and how columns are read and written. (model/EQUATIONS.md section 11)

#include "model/basis/lanes.hpp"
#include "model/variator/rigid/rigid_kernels.hpp"

namespace cvtflow::model {
namespace {

using PinLanes = Lanes<rigid_lanes>;

struct Plane {
    PinLanes x, y;
    friend Plane operator+(const Plane& a, const Plane& b) noexcept { return {a.x + b.x, a.y + b.y}; }
    friend Plane operator-(const Plane& a, const Plane& b) noexcept { return {a.x - b.x, a.y - b.y}; }
    friend Plane operator*(const PinLanes& f, const Plane& a) noexcept { return {f * a.x, f * a.y}; }
    friend PinLanes dot(const Plane& a, const Plane& b) noexcept { return a.x * b.x + a.y * b.y; }
    /// z component of the cross product.
    friend PinLanes cross(const Plane& a, const Plane& b) noexcept { return a.x * b.y - a.y * b.x; }
    /// k×a
    friend Plane turned(const Plane& a) noexcept { return {-a.y, a.x}; }
};

/// Entries i … i + 7 of a column.
[[nodiscard, gnu::always_inline]] inline PinLanes read(const RigidColumns& columns, Column c, int i) noexcept {
    return load<rigid_lanes>(columns[c] + i);
}
/// A column and the one behind it.
[[nodiscard, gnu::always_inline]] inline Plane read_plane(const RigidColumns& columns, Column c, int i) noexcept {
    return {read(columns, c, i), read(columns, c + 1, i)};
}
[[gnu::always_inline]] inline void write(RigidColumns& columns, Column c, int i, const PinLanes& value) noexcept {
    value.copy_to(columns[c] + i);
}
[[gnu::always_inline]] inline void write_plane(RigidColumns& columns, Column c, int i, const Plane& value) noexcept {
    write(columns, c, i, value.x);
    write(columns, c + 1, i, value.y);
}

/// Power that a damping force takes away, and the force into its column. A force acts over a step, and the velocity that begins it is
/// the one that ended the step before: its share of the work is the mean of both steps' forces times it.
[[nodiscard, gnu::always_inline]] inline PinLanes drag_power(const RigidKick& kick, RigidColumns& columns, Column c, int i,
                                                             const PinLanes& force, const PinLanes& rate) noexcept {
    const PinLanes acting = kick.implicit() ? 0.5 * (force + read(columns, c, i)) : force;
    write(columns, c, i, force);
    return acting * rate;
}

/// A sum over pins, without those that only fill the last vector.
class PinSum {
public:
    explicit PinSum(const RigidColumns& columns) noexcept : pins_(columns.pins()) {}
    void add(int i, const PinLanes& terms) noexcept {
        if (i + rigid_lanes <= pins_) {
            total_ += terms;
            return;
        }
        for (int lane = 0; i + lane < pins_; ++lane) {
            const auto k = static_cast<std::size_t>(lane);
            total_.set(k, total_[k] + terms[k]);
        }
    }
    [[nodiscard]] double value() const noexcept { return sum<rigid_lanes>(total_); }

private:
    int pins_;
    PinLanes total_{0.0};
};

}  // namespace
}  // namespace cvtflow::model
