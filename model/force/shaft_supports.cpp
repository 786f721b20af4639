#include "model/force/shaft_supports.hpp"

#include "model/force/pulley_coordinates.hpp"

namespace cvtflow::model {

void ShaftSupports::adopt(const Parameters& p) {
    damping_ratio_ = p.pulley.damping_ratio;
    supports_.clear();
    if (p.detail.pulleys != PulleyDetail::elastic) return;
    for (int shaft = 0; shaft < 2; ++shaft) {
        add_bearings(p.pulley, shaft);
        for (int side = 0; side < 2; ++side) add_attachment(p, shaft, side);
    }
}

void ShaftSupports::spring(std::array<int, 3> index, std::array<double, 3> factor, double stiffness, double mass) {
    std::size_t terms = factor.size();
    while (terms > 1 && factor[terms - 1] == 0.0) --terms;
    supports_.push_back({index, factor, damped_spring(stiffness, mass, damping_ratio_), terms});
}

void ShaftSupports::add_bearings(const Pulley& pulley, int shaft) {
    using enum PulleyCoordinates::Freedom;
    const auto on = [&](int freedom) { return std::array<int, 3>{body_freedom(shaft, freedom), 0, 0}; };
    constexpr std::array<double, 3> one{1.0, 0.0, 0.0};
    spring(on(ux), one, pulley.bearing_radial, pulley.shaft_mass);
    spring(on(uy), one, pulley.bearing_radial, pulley.shaft_mass);
    spring(on(axial), one, pulley.bearing_axial, pulley.shaft_mass);
    spring(on(tilt_x), one, pulley.bearing_tilt, pulley.shaft_tilt_inertia);
    spring(on(tilt_y), one, pulley.bearing_tilt, pulley.shaft_tilt_inertia);
}

void ShaftSupports::add_attachment(const Parameters& p, int shaft, int side) {
    using enum PulleyCoordinates::Freedom;
    const Pulley& pulley = p.pulley;
    const bool imperfect = 2 * shaft + side == static_cast<int>(p.imperfection.sheave);
    const int body = sheave_body(shaft, side);
    const double z = (side == 0 ? -0.5 : 0.5) * p.half.length;
    const auto between = [&](int freedom) { return std::array<int, 3>{body_freedom(body, freedom), body_freedom(shaft, freedom), 0}; };
    constexpr std::array<double, 3> difference{1.0, -1.0, 0.0};
    auto radial_x = between(ux);
    radial_x[2] = body_freedom(shaft, tilt_y);
    spring(radial_x, {1.0, -1.0, -z}, pulley.attachment_radial, pulley.sheave_mass);
    auto radial_y = between(uy);
    radial_y[2] = body_freedom(shaft, tilt_x);
    spring(radial_y, {1.0, -1.0, z}, pulley.attachment_radial, pulley.sheave_mass);
    if (body != PulleyCoordinates::movable_body(shaft)) spring(between(axial), difference, pulley.attachment_axial, pulley.sheave_mass);
    const double against_tilt = imperfect ? p.imperfection.attachment * pulley.attachment_tilt : pulley.attachment_tilt;
    spring(between(tilt_x), difference, against_tilt, pulley.sheave_tilt_inertia);
    spring(between(tilt_y), difference, against_tilt, pulley.sheave_tilt_inertia);
    spring(between(turn), difference, pulley.attachment_torsion, pulley.sheave_polar_inertia);
}

void ShaftSupports::add(const double* q, const double* v, double* force, Account* account) const noexcept {
    double stored = 0.0, lost = 0.0;
    for (const Support& s : supports_) {
        double u = 0.0;
        double rate = 0.0;
        for (std::size_t k = 0; k < s.terms; ++k) {
            u += s.factor[k] * q[s.index[k]];
            rate += s.factor[k] * v[s.index[k]];
        }
        const double f = s.spring.stiffness * u + s.spring.damping * rate;
        for (std::size_t k = 0; k < s.terms; ++k) force[s.index[k]] -= s.factor[k] * f;
        stored += 0.5 * s.spring.stiffness * u * u;
        lost += s.spring.damping * rate * rate;
    }
    if (account == nullptr) return;
    account->store(Energy::supports, stored);
    account->lose(Loss::supports, lost);
}

/// A bearing is a support with one body alone.
BearingLoad ShaftSupports::bearing(const double* q, const double* v, int shaft) const noexcept {
    constexpr std::size_t radial_x = 0, radial_y = 1, tilt_about_x = 2, tilt_about_y = 3, along = 4;
    std::array<double, 6> load{};
    for (const Support& s : supports_) {
        const int freedom = s.index[0] - body_freedom(shaft, 0);
        if (s.factor[1] != 0.0 || freedom < 0 || freedom >= 6) continue;
        load[static_cast<std::size_t>(freedom)] += s.spring.stiffness * q[s.index[0]] + s.spring.damping * v[s.index[0]];
    }
    return {{load[radial_x], load[radial_y], load[along]}, {load[tilt_about_x], load[tilt_about_y]}};
}

}  // namespace cvtflow::model
