#include "model/machine/coefficients.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "model/basis/portable_math.hpp"
#include "model/machine/belt.hpp"

namespace cvtflow::model {

Spring damped_spring(double stiffness, double effective_mass, double damping_ratio) noexcept {
    return {stiffness, 2.0 * damping_ratio * std::sqrt(stiffness * effective_mass)};
}

std::vector<double> plate_positions(const Parameters& parameters) {
    const int n = parameters.plate.count;
    const double outermost = 2.0 * parameters.plate.span / parameters.half.length;
    std::vector<double> each;
    for (int j = 0; j < n; ++j) each.push_back(n == 1 ? 0.0 : outermost * (2.0 * j / (n - 1) - 1.0));
    if (parameters.detail.plates == PlateDetail::each) return each;
    double square = 0.0;
    for (const double xi : each) square += xi * xi;
    const double radius = std::sqrt(square / n);
    return {-radius, radius};
}

std::vector<double> longer_halves(const Parameters& parameters) {
    constexpr double cut = 3.0;
    const Imperfection& of = parameters.imperfection;
    if (of.pin_length_spread == 0.0) return {};
    std::mt19937_64 generator(of.pin_length_seed);
    const auto uniform = [&] { return static_cast<double>(generator() >> 11) * 0x1p-53; };
    std::vector<double> longer;
    while (longer.size() < static_cast<std::size_t>(parameters.chain.pins)) {
        const double deviations = cut * (2.0 * uniform() - 1.0), density = portable_pow(std::numbers::e, -0.5 * deviations * deviations);
        if (uniform() < density) longer.push_back(0.5 * of.pin_length_spread * deviations);
    }
    return longer;
}

namespace {

/// Mass at a spring of the chain: half of a pin half with its share of plates.
double chain_mass(const Parameters& p) noexcept { return 0.5 * (p.half.mass + 0.5 * p.plate.count * p.plate.mass); }

int lane_width(int count) noexcept {
    int width = 1;
    while (width < count && width < 16) width *= 2;
    return width;
}

template <int Most>
PointLanes<Most> lanes_at(const std::vector<double>& positions) {
    PointLanes<Most> lanes;
    lanes.count = static_cast<int>(positions.size());
    lanes.width = lane_width(lanes.count);
    for (std::size_t j = 0; j < lanes.position.size(); ++j) {
        const double xi = j < positions.size() ? positions[j] : 0.0;
        lanes.position[j] = xi;
        for (int m = 0; m < axis_terms; ++m) lanes.basis[static_cast<std::size_t>(m)][j] = legendre(m, xi);
    }
    return lanes;
}

PointLanes<max_plate_lanes> plate_lanes(const Parameters& p) {
    const std::vector<double> positions = plate_positions(p);
    auto lanes = lanes_at<max_plate_lanes>(positions);
    const double total = p.plate.count * p.plate.stiffness;
    const double damping = damped_spring(total, chain_mass(p), p.chain.damping_ratio).damping;
    for (std::size_t j = 0; j < positions.size(); ++j) {
        lanes.weight[j] = total / static_cast<double>(positions.size());
        lanes.damping[j] = damping / static_cast<double>(positions.size());
    }
    return lanes;
}

PointLanes<max_joint_lanes> joint_lanes(const Parameters& p) {
    const Quadrature rule = gauss_legendre(p.detail.joint_points);
    auto lanes = lanes_at<max_joint_lanes>(rule.position);
    std::copy(rule.weight.begin(), rule.weight.end(), lanes.weight.begin());
    return lanes;
}

BendingLanes bending_lanes(const Parameters& p, double rigidity) {
    const double cube = p.half.length * p.half.length * p.half.length;
    const Spring second = damped_spring(144.0 * rigidity / cube, p.half.mass / 5.0, p.chain.damping_ratio);
    const Spring third = damped_spring(1200.0 * rigidity / cube, p.half.mass / 7.0, p.chain.damping_ratio);
    return {{second.stiffness, third.stiffness, second.stiffness, third.stiffness},
            {second.damping, third.damping, second.damping, third.damping}};
}

LinkKind link_kind(const Parameters& p, double pitch) {
    const double length = pitch + p.half.width;
    const double stiffness = p.plate.count * p.plate.bending_stiffness / length;
    const double tilt_inertia = 0.5 * p.half.mass / 3.0 * 0.25 * p.half.length * p.half.length;
    const double zeta = p.chain.damping_ratio;
    return {length, 1.0 / length, damped_spring(stiffness, tilt_inertia, zeta), damped_spring(3.0 * stiffness, tilt_inertia, zeta),
            damped_spring(p.plate.count * p.plate.torsion_stiffness, tilt_inertia, zeta)};
}

/// Share of the width of contact that slides in effect: the loss is that of joints between halves. (model/EQUATIONS.md section 11)
constexpr double rolling_share = 0.11;

/// Half the width over which two profiles of radius ρ touch under N is sqrt(ρ N/k_J).
double rolling_arm(const Parameters& p) noexcept { return rolling_share * std::sqrt(p.joint.radius / p.joint.stiffness); }

JointCoefficients joint_coefficients(const Parameters& p) {
    const double zeta = p.chain.damping_ratio;
    const double mass = chain_mass(p);
    const auto& j = p.joint;
    return {j.radius - 0.5 * p.half.width,
            2.0 * j.radius,
            j.stiffness,
            2.0 * zeta * std::sqrt(mass / j.stiffness) / j.reference_depth,
            j.law == JointLaw::palmgren,
            j.reference_depth,
            j.clearance,
            j.clearance_stiffness,
            2.0 * zeta * std::sqrt(mass / j.clearance_stiffness) / j.clearance,
            FrictionCurve(j.friction, p.detail),
            rolling_arm(p)};
}

TipCoefficients tip_coefficients(const Parameters& p) {
    const auto& t = p.tip;
    const double root = std::sqrt(t.reference_depth);
    const double critical = 2.0 * std::sqrt(1.5 * t.hertz * root * p.half.mass);
    const double sine = portable_sin(t.angle);
    const double cosine = portable_cos(t.angle);
    return {sine,
            cosine,
            t.radius,
            p.pulley.arc_radius + t.radius,
            p.pulley.arc_position + t.radius * sine,
            t.hertz,
            p.chain.damping_ratio * critical / (t.hertz * t.reference_depth * root),
            FrictionCurve({t.largest_friction(), t.friction.saturation_speed}, p.detail),
            tip_law(p, p.oil.temperature)};
}

GuideCoefficients guide_coefficients(const Parameters& p) {
    constexpr double ramp_share = 0.2;  // of a rail, at each end
    constexpr double full_speed = 1.0;  // below, friction is proportional to the speed: a twentieth of a usual chain's [m/s]
    if (!p.guide.present()) return {};
    const double distance = p.pulley.centre_distance;
    const auto radii = belt_radii(chain_length(p.chain), p.start.ratio, distance);
    if (!radii) throw std::invalid_argument("guide.stiffness: at start.ratio the chain runs on no radii");
    const double sine = (radii->driven - radii->driving) / distance, cosine = std::sqrt(1.0 - sine * sine), strand = distance * cosine;
    const auto& [stiffness, damping, clearance, offset, friction, begin, end] = p.guide;
    return {true,           stiffness,    damping,
            clearance,      friction,     1.0 / full_speed,
            sine,           cosine,       radii->driving + offset,
            begin * strand, end * strand, 1.0 / (ramp_share * (end - begin) * strand)};
}

double mean_bow(const Parameters& p) {
    double sum = 0.0;
    const std::vector<double> positions = plate_positions(p);
    for (const double xi : positions) sum += 0.5 * (3.0 * xi * xi - 1.0);
    return sum / static_cast<double>(positions.size());
}

}  // namespace

Coefficients::Coefficients(const Parameters& p)
    : layout(layout_of(p)),
      half_length(0.5 * p.half.length),
      slope_scale(2.0 / p.half.length),
      plates(plate_lanes(p)),
      plate_friction(p.plate.friction, p.detail),
      joint_points(joint_lanes(p)),
      joint(joint_coefficients(p)),
      tip(tip_coefficients(p)),
      guide(guide_coefficients(p)),
      clamping_limit(SpeedProfile::through(p.wear.clamping_limit.speed, p.wear.clamping_limit.value)),
      eccentric(p.imperfection.runout != 0.0),
      longer(longer_halves(p)),
      middle(0.5 * p.pulley.centre_distance),
      centre_distance(p.pulley.centre_distance),
      plate_bow(mean_bow(p)) {
    extension = damped_spring(4.0 * p.chain.young_modulus * p.half.area / p.half.length, p.half.mass / 3.0, p.chain.damping_ratio);
    travel = bending_lanes(p, p.half.bending_travel);
    height = bending_lanes(p, p.half.bending_height);
    std::vector<double> pitches;
    for (int link = 0; link < p.chain.pins; ++link) {
        const double pitch = p.chain.pitch[static_cast<std::size_t>(link) % p.chain.pitch.size()];
        const auto known = std::find(pitches.begin(), pitches.end(), pitch);
        kind_of.push_back(static_cast<int>(known - pitches.begin()));
        if (known != pitches.end()) continue;
        pitches.push_back(pitch);
        kinds.push_back(link_kind(p, pitch));
    }
}

}  // namespace cvtflow::model
