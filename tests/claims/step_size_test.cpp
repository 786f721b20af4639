/// RK4 on the baseline: accurate at 5e-8 s, chattering at 8e-8 s, as its stability interval and the spectrum predict.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// Relative difference of the axial forces of all tips.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double square = 0.0;
    double norm = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        square += (a[k] - b[k]) * (a[k] - b[k]);
        norm += b[k] * b[k];
    }
    return std::sqrt(square / norm);
}

TEST(StepSize, FiftyNanosecondsAreAccurateAndEightyChatter) {
    const auto forces = [](const char* step) {
        const Operation run(ready_scene("baseline", {"run.method=rk4", "run.until=80 us", "run.output_interval=40 us",
                                                     "run.state_interval=40 us", std::string("run.step=") + step}));
        EXPECT_FALSE(run.fault) << run.fault.message();
        return run.tip_axial.back();
    };
    const auto reference = forces("12.5 ns");
    const double fifty = difference(forces("50 ns"), reference);
    const double eighty = difference(forces("80 ns"), reference);
    RecordProperty("error_50ns", std::to_string(fifty));
    RecordProperty("error_80ns", std::to_string(eighty));
    // h λ at 6e7 1/s is 3.0 and 4.8, RK4 is stable to 2.785: the friction of a few joints chatters a little at 50 ns, all of it at 80 ns.
    EXPECT_LT(fifty, 1e-3);
    EXPECT_GT(eighty, 10.0 * fifty);
}

}  // namespace
}  // namespace cvtflow::claims
