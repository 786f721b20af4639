#include "model/force/pulley.hpp"

namespace cvtflow::model {

/// A bearing is a support with one body alone.
BearingLoad PulleyModel::sprung_bearing(const double* block, int shaft) const noexcept {
    constexpr std::size_t radial_x = 0, radial_y = 1, tilt_about_x = 2, tilt_about_y = 3, along = 4;
    std::array<double, 6> load{};
    for (const Support& s : supports_) {
        const int freedom = s.index[0] - body_freedom(shaft, 0);
        if (s.factor[1] != 0.0 || freedom < 0 || freedom >= 6) continue;
        load[static_cast<std::size_t>(freedom)] += s.spring.stiffness * block[s.index[0]] + s.spring.damping * block[size_ + s.index[0]];
    }
    return {{load[radial_x], load[radial_y], load[along]}, {load[tilt_about_x], load[tilt_about_y]}};
}

/// Virtual work: a sheave at z_s follows its shaft by u_x + τ_y z_s, u_y - τ_x z_s and τ. The cylinder pushes the movable sheave and the
/// shaft apart.
BearingLoad PulleyModel::held_bearing(const double* block, int shaft, const Inputs& inputs, const SheaveForces& chain) const noexcept {
    BearingLoad load;
    for (int side = 0; side < 2; ++side) {
        const auto& [fx, fy, about_x, about_y, axial, turn] = chain[static_cast<std::size_t>(2 * shaft + side)];
        const double z = side == 0 ? -half_length_ : half_length_;
        load.force[0] += fx;
        load.force[1] += fy;
        load.moment[0] += about_x - z * fy;
        load.moment[1] += about_y + z * fx;
        if (sheave_body(shaft, side) != movable_body(shaft)) load.force[2] += axial;
    }
    const double rate = opening(block + size_, shaft);
    load.force[2] += movable_side(shaft) * inputs.clamping[static_cast<std::size_t>(shaft)] + pulley_.cylinder_damping * rate;
    return load;
}

std::array<BearingLoad, 2> PulleyModel::bearings(const double* block, const Inputs& inputs, const SheaveForces& chain) const noexcept {
    if (elastic()) return {sprung_bearing(block, 0), sprung_bearing(block, 1)};
    return {held_bearing(block, 0, inputs, chain), held_bearing(block, 1, inputs, chain)};
}

}  // namespace cvtflow::model
