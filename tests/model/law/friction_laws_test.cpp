#include "model/law/friction_laws.hpp"

#include <gtest/gtest.h>

#include "law_properties.hpp"

namespace cvtflow::model {
namespace {

TEST(FrictionLaws, AllOweTheSame) {
    for (std::size_t law = 0; law < friction_law_names.size(); ++law) {
        SCOPED_TRACE(friction_law_names[law]);
        for (const double d : {0.1, 0.5}) {
            Detail detail;
            detail.friction = static_cast<FrictionLaw>(law);
            detail.smoothing = d;
            expect_a_law<FrictionLaws>(FrictionCurve({0.09, 0.01}, detail));
        }
    }
}

TEST(FrictionLaws, EachNameHasALawOfItsOwn) {
    for (std::size_t law = 0; law < friction_law_names.size(); ++law) {
        const auto chosen = FrictionLaws::visit(static_cast<FrictionLaw>(law), [](auto of) { return of.law; });
        EXPECT_EQ(chosen, static_cast<FrictionLaw>(law)) << friction_law_names[law];
    }
}

TEST(FrictionLaws, ACurveWithoutItsCornerIsThePiecewiseOne) {
    Detail detail;
    detail.friction = FrictionLaw::smoothed;
    const FrictionCurve plain = FrictionCurve({0.09, 0.01}, detail).piecewise();
    EXPECT_EQ(plain.coefficient, 0.09);
    for (const double u : law_speeds) EXPECT_NEAR(share_at<FrictionLaws>(plain, u * 0.01), std::min(u, 1.0), 1e-15) << u;
}

}  // namespace
}  // namespace cvtflow::model
