#include "tests/oracle/friction.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace cvtflow::oracle {

Real saturation(const model::Detail& detail, Real u) {
    if (detail.friction == model::FrictionLaw::piecewise) return std::min(u, 1.0L);
    const Real d = detail.smoothing;
    if (u <= 1.0L - d) return u;
    if (u >= 1.0L + d) return 1.0L;
    return 1.0L - (1.0L + d - u) * (1.0L + d - u) / (4.0L * d);
}

Real friction_slope(const model::Detail& detail, const model::Friction& friction, Real speed) {
    const Real v0 = friction.saturation_speed;
    if (speed == 0.0L) return 1.0L / v0;
    return saturation(detail, speed / v0) / speed;
}

namespace {

struct Knots {
    std::vector<Real> speed, value;
};

/// Fritsch and Carlson's slope at an inner knot, by the weighted harmonic mean; level at the ends.
Real slope_at(const Knots& knots, std::size_t k) {
    if (k == 0 || k + 1 == knots.speed.size()) return 0.0L;
    const Real before = knots.speed[k] - knots.speed[k - 1], after = knots.speed[k + 1] - knots.speed[k];
    const Real left = (knots.value[k] - knots.value[k - 1]) / before, right = (knots.value[k + 1] - knots.value[k]) / after;
    if (left * right <= 0.0L) return 0.0L;
    const Real a = 2.0L * after + before, b = after + 2.0L * before;
    return (a + b) / (a / left + b / right);
}

/// Hermite's cubic of the interval that the speed is in.
Real interpolated(const Knots& knots, Real speed) {
    if (speed <= knots.speed.front()) return knots.value.front();
    if (speed >= knots.speed.back()) return knots.value.back();
    std::size_t k = 0;
    while (speed > knots.speed[k + 1]) ++k;
    const Real width = knots.speed[k + 1] - knots.speed[k], t = (speed - knots.speed[k]) / width;
    const Real h00 = (1.0L + 2.0L * t) * (1.0L - t) * (1.0L - t), h10 = t * (1.0L - t) * (1.0L - t);
    const Real h01 = t * t * (3.0L - 2.0L * t), h11 = t * t * (t - 1.0L);
    return h00 * knots.value[k] + h10 * width * slope_at(knots, k) + h01 * knots.value[k + 1] + h11 * width * slope_at(knots, k + 1);
}

Real modulus(const model::Parameters& p) { return 0.5L * p.chain.young_modulus / (1.0L - 0.09L); }
Real contact_radius(const model::Parameters& p) {
    const Real root = 3.0L * p.tip.hertz / (4.0L * modulus(p));
    return root * root;
}

/// Vogel: ln η = a + b/(θ + 95 °C), from two points.
Real viscosity(const model::Oil& oil) {
    const Real at_40 = 1.0L / 135.0L, at_100 = 1.0L / 195.0L, now = 1.0L / (oil.temperature - 273.15L + 95.0L);
    const Real b = (std::log(Real{oil.viscosity_40}) - std::log(Real{oil.viscosity_100})) / (at_40 - at_100);
    return std::exp(std::log(Real{oil.viscosity_40}) + b * (now - at_40));
}

Real film(const model::Parameters& p, Real speed) {
    const Real e = 2.0L * modulus(p), r = contact_radius(p), load = p.tip.hertz * std::pow(Real{p.tip.reference_depth}, 1.5L);
    const Real h = 2.69L * std::pow(viscosity(p.oil) * speed / 2.0L / (e * r), 0.67L) * std::pow(p.oil.pressure_viscosity * e, 0.53L) *
                   std::pow(load / (e * r * r), -0.067L) * 0.706L;
    return h * r / p.tip.roughness;
}

Knots knots_of(const model::Parameters& p) {
    Knots knots;
    const Real full = p.tip.friction.coefficient, film_coefficient = p.tip.limiting_traction;
    if (p.tip.friction_law == model::TipFriction::table) {
        for (std::size_t k = 0; k < p.tip.friction_table.speed.size(); ++k) {
            knots.speed.push_back(p.tip.friction_table.speed[k]);
            knots.value.push_back(p.tip.friction_table.value[k] / full);
        }
        return knots;
    }
    for (int k = 0; k < 16; ++k) {
        const Real ratio = 1e-3L * std::pow(5e4L, k / 15.0L);
        knots.speed.push_back(std::pow(ratio / film(p, 1.0L), 1.0L / 0.67L));
        knots.value.push_back((film_coefficient + (full - film_coefficient) / ((1.0L + ratio) * (1.0L + ratio))) / full);
    }
    return knots;
}

}  // namespace

Real tip_law_factor(const model::Parameters& p, Real speed, Real depth) {
    const Real by_speed = p.tip.friction_law == model::TipFriction::constant ? 1.0L : interpolated(knots_of(p), speed);
    const Real pressure = 2.0L * modulus(p) / std::numbers::pi_v<Real> * std::sqrt(depth / contact_radius(p));
    return by_speed * std::max(0.0L, 1.0L + p.tip.pressure_sensitivity * (pressure / p.tip.reference_pressure - 1.0L));
}

}  // namespace cvtflow::oracle
