#include "model/law/friction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "model/basis/portable_math.hpp"
#include "model/law/friction_laws.hpp"

namespace cvtflow::model {

FrictionCurve::FrictionCurve(const Friction& friction, const Detail& detail) noexcept
    : coefficient(friction.coefficient),
      saturation_speed(friction.saturation_speed),
      law(detail.friction),
      inverse_saturation_speed(1.0 / saturation_speed) {
    FrictionLaws::visit(law, [&](auto of) {
        proportional_speed = std::max(of.proportional(detail.smoothing), 1e-30) * saturation_speed;  // nothing is divided by zero
        full_speed = of.full(detail.smoothing) * saturation_speed;
        shape = of.shape(detail.smoothing, saturation_speed);
    });
    linear_speed_squared = (1.0 - 1e-12) * proportional_speed * proportional_speed;
}

namespace {

/// Slope at a knot between two intervals: 0 at an extremum, else a weighted harmonic mean of both secants.
[[nodiscard]] double knot_slope(double width_before, double secant_before, double width_after, double secant_after) noexcept {
    if (secant_before * secant_after <= 0.0) return 0.0;
    const double before = 2.0 * width_after + width_before, after = width_after + 2.0 * width_before;
    return (before + after) / (before / secant_before + after / secant_after);
}

/// Film ratios at the knots of the lubricated law: up to the first one the contact is a boundary contact to 0.2 %, beyond the last one the
/// film carries all but 0.04 %.
constexpr double thinnest = 1e-3, thickest = 50.0;
/// Power of the speed in the film thickness.
constexpr double speed_power = 0.67;

/// Knots at equal ratios of the film.
[[nodiscard]] SpeedProfile lubricated_profile(const Parameters& p, double temperature) noexcept {
    constexpr std::size_t count = SpeedProfile::max_knots;
    std::array<double, count> speed{}, value{};
    const double unit = 1.0 / portable_pow(film_ratio(p, 1.0, temperature), 1.0 / speed_power);  // speed at which the ratio is 1
    for (std::size_t k = 0; k < count; ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(count - 1);
        speed[k] = unit * portable_pow(thinnest * portable_pow(thickest / thinnest, share), 1.0 / speed_power);
        value[k] = lubricated_coefficient(p, speed[k], temperature) / p.tip.friction.coefficient;
    }
    return SpeedProfile::through(speed, value);
}

/// Shares of the table's largest value.
[[nodiscard]] SpeedProfile table_profile(const SpeedTable& table) {
    const double largest = *std::ranges::max_element(table.value);
    std::vector<double> share = table.value;
    for (double& value : share) value = largest > 0.0 ? value / largest : 1.0;
    return SpeedProfile::through(table.speed, share);
}

}  // namespace

SpeedProfile SpeedProfile::through(std::span<const double> speed, std::span<const double> value) noexcept {
    SpeedProfile profile;
    profile.first = value[0];
    const std::size_t knots = std::min(speed.size(), max_knots);
    std::array<double, max_knots> width{}, secant{}, slope{};
    for (std::size_t k = 0; k + 1 < knots; ++k) {
        width[k] = speed[k + 1] - speed[k];
        secant[k] = (value[k + 1] - value[k]) / width[k];
    }
    for (std::size_t k = 1; k + 1 < knots; ++k) slope[k] = knot_slope(width[k - 1], secant[k - 1], width[k], secant[k]);
    profile.intervals = static_cast<int>(knots) - 1;
    for (std::size_t k = 0; k + 1 < knots; ++k) {
        const double rise = width[k] * secant[k], from = width[k] * slope[k], to = width[k] * slope[k + 1];
        profile.begin[k] = speed[k];
        profile.inverse[k] = 1.0 / width[k];
        profile.linear[k] = from;
        profile.square[k] = 3.0 * rise - 2.0 * from - to;
        profile.cube[k] = from + to - 2.0 * rise;
    }
    return profile;
}

double SpeedProfile::at(double speed) const noexcept {
    double sum = first;
    for (std::size_t k = 0; k < static_cast<std::size_t>(intervals); ++k) {
        const double t = std::clamp((speed - begin[k]) * inverse[k], 0.0, 1.0);
        sum += t * (linear[k] + t * (square[k] + t * cube[k]));
    }
    return sum;
}

double contact_modulus(const Parameters& parameters) noexcept {
    constexpr double poisson = 0.3;
    return 0.5 * parameters.chain.young_modulus / (1.0 - poisson * poisson);
}

double contact_radius(const Parameters& parameters) noexcept {
    const double root = 0.75 * parameters.tip.hertz / contact_modulus(parameters);
    return root * root;
}

/// p = (2 E*/π) √(δ/R).
double pressure_per_root_depth(const Parameters& parameters) noexcept {
    return 2.0 * contact_modulus(parameters) / (std::numbers::pi * std::sqrt(contact_radius(parameters)));
}

double oil_viscosity(const Oil& oil, double temperature) noexcept {
    constexpr double zero = 178.15, warm = 313.15, hot = 373.15;  // -95, 40 and 100 °C [K]
    const auto inverse = [](double t) { return 1.0 / (t - zero); };
    const double share = (inverse(warm) - inverse(temperature)) / (inverse(warm) - inverse(hot));
    return oil.viscosity_40 * portable_pow(oil.viscosity_100 / oil.viscosity_40, share);
}

/// H = 2.69 U^0.67 G^0.53 W^-0.067 (1 - 0.61 e^{-0.73}) of a circular contact, at the reference depth's force.
double film_ratio(const Parameters& p, double speed, double temperature) noexcept {
    const double modulus = contact_modulus(p), radius = contact_radius(p);
    const double depth = p.tip.reference_depth, force = p.tip.hertz * depth * std::sqrt(depth);
    const double entrained = 0.5 * oil_viscosity(p.oil, temperature) * speed / (2.0 * modulus * radius);
    const double film = 2.69 * 0.706 * portable_pow(entrained, speed_power) * portable_pow(p.oil.pressure_viscosity * 2.0 * modulus, 0.53) *
                        portable_pow(force / (2.0 * modulus * radius * radius), -0.067);
    return film * radius / p.tip.roughness;
}

double lubricated_coefficient(const Parameters& p, double speed, double temperature) noexcept {
    const double ratio = 1.0 + film_ratio(p, speed, temperature);
    return p.tip.limiting_traction + (p.tip.friction.coefficient - p.tip.limiting_traction) / (ratio * ratio);
}

void warm(TipLaw& law, const Parameters& p, double temperature) noexcept {
    if (p.tip.friction_law != TipFriction::lubricated || p.tip.friction.coefficient <= 0.0) return;
    law.by_speed = lubricated_profile(p, temperature);
}

std::shared_ptr<TipLaw> tip_law(const Parameters& p, double temperature) {
    if (p.tip.friction_law == TipFriction::constant && p.tip.pressure_sensitivity == 0.0) return nullptr;
    auto law = std::make_shared<TipLaw>();
    if (p.tip.friction_law == TipFriction::table) law->by_speed = table_profile(p.tip.friction_table);
    warm(*law, p, temperature);
    law->without_pressure = 1.0 - p.tip.pressure_sensitivity;
    law->memory = p.tip.friction_memory;
    law->per_root_depth = p.tip.pressure_sensitivity * pressure_per_root_depth(p) / p.tip.reference_pressure;
    return law;
}

}  // namespace cvtflow::model
