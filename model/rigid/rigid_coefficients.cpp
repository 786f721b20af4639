#include "model/rigid/rigid_coefficients.hpp"

#include <algorithm>
#include <cmath>

namespace cvtflow::model {

namespace {

/// Parameters at the detail that both chains' coefficients share: plates as a pack.
[[nodiscard]] Parameters with_plate_pack(Parameters p) {
    p.detail.plates = PlateDetail::lumped;
    return p;
}

[[nodiscard]] double mean_square_position(const Parameters& p) {
    double sum = 0.0;
    const std::vector<double> positions = plate_positions(p);
    for (const double xi : positions) sum += xi * xi;
    return sum / static_cast<double>(positions.size());
}

/// Mean square deviation of the plates' places from their mean on a pin that is bent by P_2.
[[nodiscard]] double mean_square_bow(Parameters p) {
    p.detail.plates = PlateDetail::each;
    double sum = 0.0, squares = 0.0;
    const std::vector<double> positions = plate_positions(p);
    for (const double xi : positions) {
        const double bow = 0.5 * (3.0 * xi * xi - 1.0);
        sum += bow;
        squares += bow * bow;
    }
    const double count = static_cast<double>(positions.size()), mean = sum / count;
    return squares / count - mean * mean;
}

[[nodiscard]] double in_series(double a, double b) noexcept { return a > 0.0 && b > 0.0 ? a * b / (a + b) : 0.0; }

}  // namespace

RigidCoefficients::RigidCoefficients(const Parameters& parameters) {
    const Parameters p = with_plate_pack(parameters);
    const Coefficients c(p);
    const double plates = p.plate.count * p.plate.mass;
    const double zeta = p.chain.damping_ratio;
    pins = p.chain.pins;
    mass = 2.0 * p.half.mass + plates;
    plate_square = mean_square_position(p);
    plate_reach = std::sqrt(plate_square);
    tilt_mass = 2.0 * p.half.mass / 3.0 + plates * plate_square;
    slide_mass = 0.25 * mass;
    half_length = c.half_length;
    unequal = !c.longer.empty();
    half_longest = half_length + (unequal ? *std::max_element(c.longer.begin(), c.longer.end()) : 0.0);
    pull = damped_spring(in_series(p.plate.count * p.plate.stiffness, p.joint.stiffness), 0.25 * mass, zeta);
    bend(p, c.plate_bow);
    arm = c.joint.arm;
    diameter = c.joint.diameter;
    rolling_arm = c.joint.rolling_arm;
    plate_friction = c.plate_friction;
    joint_friction = c.joint.friction;
    sine = c.tip.sine;
    cosine = c.tip.cosine;
    radius = c.tip.radius;
    outward = radius * sine;
    inverse_reach = 1.0 / c.tip.reach;
    touching_radius = c.tip.touching_radius;
    lever = 1.0 - c.slope_scale * radius * cosine;
    bend_lever = 1.0 - bend_slope * c.slope_scale * radius * cosine;
    hertz = p.tip.hertz;
    damping = c.tip.damping;
    softness = hertz * cosine * cosine * half_length / (p.chain.young_modulus * p.half.area);
    further_steps = softness * std::sqrt(p.tip.deepest) > well_started_softness ? 4 : 0;
    tip_friction = c.tip.friction;
    tip_law = c.tip.law;
    middle = c.middle;
    guide = c.guide;
}

void RigidCoefficients::bend(const Parameters& p, double plate_bow) {
    bend_share = 1.0 - plate_bow;
    const double square = bend_share * bend_share;
    bend_mass = rigid_bending_inertia * 2.0 * p.half.mass / 5.0 / square;
    const auto bending = [&](double rigidity) {
        return damped_spring(288.0 * rigidity / std::pow(p.half.length, 3) / square, bend_mass, p.chain.damping_ratio);
    };
    travel = bending(p.half.bending_travel);
    height = bending(p.half.bending_height);
    bend_slope = 3.0 / bend_share;
    const double share = mean_square_bow(p) / square;
    bow = {in_series(p.plate.count * p.plate.stiffness * share, p.joint.stiffness / 5.0 / square), pull.damping * share};
}

void RigidCoefficients::fill(const Parameters& parameters, RigidColumns& columns) const {
    const Parameters p = with_plate_pack(parameters);
    const Coefficients c(p);
    const double square = c.slope_scale * c.slope_scale;
    const double pack = in_series(p.plate.count * p.plate.stiffness * plate_square, p.joint.stiffness / 3.0);
    for (int link = 0; link < pins; ++link) {
        const LinkKind& kind = c.kind(link);
        columns.constants.free_length[link] = kind.free_length;
        columns.constants.inverse_length[link] = kind.inverse_length;
        columns.constants.yaw_stiffness[link] = pack + square * kind.bending.stiffness;
        columns.constants.yaw_damping[link] = pull.damping * plate_square + square * kind.bending.damping;
        columns.constants.shear_stiffness[link] = kind.shear.stiffness;
        columns.constants.shear_damping[link] = kind.shear.damping;
        columns.constants.torsion_stiffness[link] = square * kind.torsion.stiffness;
        columns.constants.torsion_damping[link] = square * kind.torsion.damping;
        columns.constants.longer[link] = unequal ? c.longer[static_cast<std::size_t>(link)] : 0.0;
    }
    columns.wrap(RowRange{columns.constants.free_length, columns.constants.longer});
}

}  // namespace cvtflow::model
