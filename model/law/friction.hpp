#pragma once
/// Numbers of friction. Regularised Coulomb friction: a contact with normal force N, coefficient μ and slip velocity v gives the force
/// -μ N g(|v|) v, g(v) = s(v/v0)/v, where s rises from 0 to 1 around the saturation speed v0. On tips μ may depend on the sliding speed (a
/// table, or a lubricated contact) and on the contact pressure. (model/EQUATIONS.md section 7)

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "model/parameters/parameters.hpp"

namespace cvtflow::model {

/// One friction law with its numbers, ready for kernels. The laws themselves are in friction_laws.hpp.
struct FrictionCurve {
    double coefficient = 0.0;       ///< μ [1]
    double saturation_speed = 1.0;  ///< v0 > 0 [m/s]
    FrictionLaw law = FrictionLaw::piecewise;

    double inverse_saturation_speed = 1.0;  ///< 1/v0, also g(0), the largest that g is [s/m]
    double proportional_speed = 1.0;        ///< speed up to which s = v/v0, ≥ 0; slightly above 0 where there is none [m/s]
    double full_speed = 1.0;                ///< speed from which s = 1; may be infinite [m/s]
    double shape = 0.0;                     ///< further number of the law [s²/m²]
    double linear_speed_squared = 0.0;      ///< a v² whose root is below the proportional speed however it is rounded [m²/s²]

    FrictionCurve() = default;
    FrictionCurve(const Friction& friction, const Detail& detail) noexcept;
};

/// Monotone C¹ interpolation with a fixed number of knots: constant below the first and above the last, in between cubics that keep the
/// order of the values (F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal. 17 (1980) 238-246).
struct SpeedProfile {
    static constexpr std::size_t max_knots = 16;

    int intervals = 0;
    double first = 1.0;                       ///< value up to the first knot
    std::array<double, max_knots> begin{};    ///< knot at the beginning of each interval [m/s]
    std::array<double, max_knots> inverse{};  ///< 1/width [s/m]
    std::array<double, max_knots> linear{};   ///< value gained within the interval: linear t + square t² + cube t³, t = 0…1
    std::array<double, max_knots> square{}, cube{};

    /// @param speed ascending, at most max_knots [m/s]
    [[nodiscard]] static SpeedProfile through(std::span<const double> speed, std::span<const double> value) noexcept;
    /// speed [m/s]
    [[nodiscard]] double at(double speed) const noexcept;
};

/// Factors on the friction that `tip.friction_coefficient` alone would give.
struct TipLaw {
    SpeedProfile by_speed;          ///< factor by sliding speed, at most 1
    double without_pressure = 1.0;  ///< pressure factor at zero pressure
    double per_root_depth = 0.0;  ///< increase of the pressure factor per √δ of Hertz' depth, as pressure is proportional to √δ [1/√m]
    double memory = 0.0;          ///< L: distance over which the argument of `by_speed` follows the sliding speed; 0: equal to it [m]
};

/// The law of a scene; nullptr for one coefficient at all speeds and pressures.
/// @param temperature of the oil, for the lubricated law [K]
[[nodiscard]] std::shared_ptr<TipLaw> tip_law(const Parameters& parameters, double temperature);
/// Changes a law to another temperature of the oil; allocates nothing. temperature [K]
void warm(TipLaw& law, const Parameters& parameters, double temperature) noexcept;

/// Dynamic viscosity by Vogel's equation through both given points [Pa·s]. temperature [K]
[[nodiscard]] double oil_viscosity(const Oil& oil, double temperature) noexcept;
/// Central film thickness over the roughness of a tip that slides with this speed (Hamrock and Dowson) [1]. speed [m/s]
[[nodiscard]] double film_ratio(const Parameters& parameters, double speed, double temperature) noexcept;
/// Coefficient of friction of the lubricated law (Olver and Spikes) [1]. speed [m/s], temperature [K]
[[nodiscard]] double lubricated_coefficient(const Parameters& parameters, double speed, double temperature) noexcept;

/// E* of tip and sheave of steel, from `chain.young_modulus` [Pa].
[[nodiscard]] double contact_modulus(const Parameters& parameters) noexcept;
/// Radius R of the equivalent sphere on a plane, from K = (4/3) E* √R [m].
[[nodiscard]] double contact_radius(const Parameters& parameters) noexcept;
/// Largest Hertz pressure per √δ [Pa/√m].
[[nodiscard]] double pressure_per_root_depth(const Parameters& parameters) noexcept;

}  // namespace cvtflow::model
