#pragma once
/// Right-hand sides of the joints and their solution, from all groups. (model/contact/slip/slip_space.hpp)

#include <algorithm>

#include "model/contact/slip/joint_reduction.hpp"
#include "model/contact/slip/slip_rows.hpp"

namespace cvtflow::model {
namespace {

template <int Points>
class SlipElimination {
public:
    using F = FloatLanes;

    SlipElimination(const SlipContacts& contacts, std::span<const SlipGroup> groups, SlipChain& chain) noexcept
        : contacts_(contacts), size_(contacts.joint_slips()), groups_(groups), c_(chain) {}

    void solve() noexcept {
        for (int joint = 0; joint < c_.stretches.length(); ++joint) right_sides(joint);
        alignas(64) float starts[slip_lanes];  // 1 where a stretch begins at joint 1
        for (int lane = 0; lane < slip_lanes; ++lane) starts[lane] = groups_[0].present.at(0)[lane] == 0.0 ? 1.0f : 0.0f;
        for (std::size_t group = 0; group < groups_.size(); ++group) c_.elements[group] = &groups_[group].element;
        JointReduction<Points>(c_, c_.elements, load(starts)).solve();
    }

private:
    /// Rᵀ (ŵ - g W φ - w) of a group's rear joints.
    void right_sides(int joint) noexcept {
        const SlipGroup& g = groups_[static_cast<std::size_t>(joint)];
        for (int point = 0; point < size_ / 2; ++point) {
            F d[2];
            for (int k = 0; k < 2; ++k) {
                const int row = 2 * contacts_.joint(End::rear, point) + k;
                alignas(64) double before[slip_lanes];
                from_before(joint, row + size_, before);
                d[k] = narrow(get(g.part, row) + load<slip_lanes>(before) - get(g.slip, row));
            }
            const int root = 4 * contacts_.joint(End::rear, point);
            for (int i = 0; i < 2; ++i)
                put(c_.sides, joint * size_ + 2 * point + i, get(g.root, root + i) * d[0] + get(g.root, root + 2 + i) * d[1]);
        }
    }
    /// The front parts of the links before. to [slip_lanes]
    void from_before(int group, int row, double* to) const noexcept {
        if (group > 1) {
            std::copy_n(groups_[static_cast<std::size_t>(group - 1)].part.at(row), slip_lanes, to);
            return;
        }
        for (int lane = 0; lane < slip_lanes; ++lane) {
            const SlipStretches::Place before = c_.stretches.before({group, lane < c_.stretches.count() ? lane : 0});
            to[lane] = groups_[static_cast<std::size_t>(before.group)].part.at(row)[before.lane];
        }
    }

    SlipContacts contacts_;
    int size_;  ///< slips of a joint
    std::span<const SlipGroup> groups_;
    SlipChain& c_;
};

}  // namespace
}  // namespace cvtflow::model
