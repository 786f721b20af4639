/// Recipe "a friction law": a struct with the functions of model/law/friction_laws.hpp. As the only law of a list it goes through
/// everything that kernels, the slip solver and the exact Jacobian call; in the program, it would be one more name in FrictionLaws.

#include <gtest/gtest.h>

#include "tests/model/law/law_properties.hpp"

namespace cvtflow::recipes {
namespace {

using model::FrictionCurve;
using model::Lanes;

/// s = u/(1 + u): rises without a corner and is never quite full.
struct RationalLaw {
    static constexpr model::FrictionLaw law = model::FrictionLaw::piecewise;  // an enumerator of its own, were it in the program

    static double proportional(double) noexcept { return 0.0; }
    static double full(double) noexcept { return std::numeric_limits<double>::infinity(); }
    static double shape(double, double) noexcept { return 0.0; }

    template <int W>
    static Lanes<W> divisor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
        return curve.saturation_speed + speed;
    }
    template <int W>
    static Lanes<W> secant(const FrictionCurve&, const Lanes<W>&, const Lanes<W>& inverse) noexcept {
        return inverse;
    }
    template <int W>
    static Lanes<W> tangent(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
        const Lanes<W> inverse = 1.0 / divisor<W>(curve, speed);
        return curve.saturation_speed * (inverse * inverse);
    }
    template <int W>
    static Lanes<W> share(const FrictionCurve& curve, const Lanes<W>& velocity) noexcept {
        return velocity * (1.0 / divisor<W>(curve, abs(velocity)));
    }
};

/// Curve that FrictionCurve's constructor makes for a law in the program's list.
FrictionCurve rational(double v0) {
    FrictionCurve curve({0.09, v0}, {});
    curve.proportional_speed = 1e-30 * v0;
    curve.full_speed = RationalLaw::full(0.0);
    curve.linear_speed_squared = 0.0;
    return curve;
}

TEST(LawRecipe, TheToyOwesWhatAllLawsOwe) { model::expect_a_law<model::LawList<RationalLaw>>(rational(0.01)); }

TEST(LawRecipe, TheToyIsTheOneThatWasMeant) {
    for (const double u : model::law_speeds)
        EXPECT_NEAR((model::share_at<model::LawList<RationalLaw>>(rational(0.01), 0.01 * u)), u / (1.0 + u), 1e-15) << u;
}

}  // namespace
}  // namespace cvtflow::recipes
