/// The table of docs/accuracy.md: rigid pins at operating points that were not used in building them.

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/claims/operating_point_fixture.hpp"
#include "tests/csv_fixture.hpp"
#include "tests/sample_fixture.hpp"

namespace cvtflow::claims {
namespace {

/// Rows of one level, by number of the point.
std::vector<test::CsvRow> published(const std::string& level) {
    std::vector<test::CsvRow> rows = test::committed_rows("bench/results/rigid_points.csv");
    std::erase_if(rows, [&](const test::CsvRow& row) { return row.at("level") != level; });
    return rows;
}

/// Means of the last 40 ms, as bench/experiments/errors takes them.
std::map<std::string, double> run_rigid(const test::CsvRow& point) {
    std::vector<std::string> settings{"start.settling_time=60 ms", "run.until=80 ms", "run.output_interval=20 us",
                                      "drive.speed=" + point.at("drive.speed") + " rpm"};
    for (const char* key : {"start.ratio", "control.ratio", "clamping.driven", "clamping.driving", "load.torque"})
        settings.push_back(std::string(key) + "=" + point.at(key));
    const Operation run(scene_at_level("control", "rigid", settings));
    EXPECT_FALSE(run.fault);
    EXPECT_LE(run.balance_error_ratio, 1.0);
    const auto mean = [&](const std::vector<double>& samples) { return run.mean(samples, 40e-3, 1.0); };
    return {{"tight", mean(run.tight)}, {"slack", mean(run.slack)}, {"slip", mean(run.slip)}, {"thrust_ratio", mean(run.thrust_ratio)}};
}

/// Both directions of torque, small and large loads.
TEST(RigidPoints, AreWhatIsPublishedAndNearFine) {
    const auto rigid = published("rigid"), fine = published("fine");
    ASSERT_EQ(rigid.size(), 24u);
    ASSERT_EQ(fine.size(), 24u);
    const std::map<std::string, double> targets{{"tight", 0.05}, {"slack", 0.05}, {"thrust_ratio", 0.05}, {"slip", 0.15}};
    for (const std::size_t number : test::depth<std::vector<std::size_t>>({4}, {4, 12, 18, 22})) {
        const auto found = run_rigid(rigid[number]);
        for (const auto& [name, target] : targets) {
            const double is = found.at(name), was = std::stod(rigid[number].at(name)), near = std::stod(fine[number].at(name));
            EXPECT_NEAR(is, was, 1e-3 * std::abs(was)) << name << " of point " << number;  // means over outputs or over the span
            EXPECT_NEAR(is, near, target * std::abs(near)) << name << " of point " << number << " against fine";
        }
    }
}

/// Sheaves more than three times as stiff as the default's: steps with another order of frictions lost 1.9 % less than short ones.
TEST(RigidPoints, LoseOnStiffSheavesWhatShortStepsLose) {
    const auto lost = [](const std::string& step) {
        const Operation run(scene_at_level("baseline", "rigid",
                                           {"pulley.attachment_tilt=5e6", "start.settling_time=30 ms", "run.until=30 ms",
                                            "run.output_interval=100 us", "run.step=" + step}));
        EXPECT_FALSE(run.fault);
        return run.lost;
    };
    const double exact = lost("1.25 us");
    EXPECT_NEAR(lost("auto"), exact, 6e-3 * exact);
}

}  // namespace
}  // namespace cvtflow::claims
