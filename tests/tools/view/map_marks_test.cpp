#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "tests/tools/program_fixture.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {
namespace {

class Maps : public Program {
protected:
    [[nodiscard]] Plot map(const std::string& table, const std::string& y = "start.ratio") const {
        return sweep_map(read_sweep((folder_ / table).string()), "load.torque", y, "slip mean");
    }
    /// Points of a series; none without it.
    [[nodiscard]] static std::vector<Point> points_of(const Plot& plot, const std::string& series) {
        const auto found = std::ranges::find(plot.series, series, &Series::name);
        return found == plot.series.end() ? std::vector<Point>{} : found->points;
    }
    /// Map over load and ratio of four cases of tiny in a folder of their own. @param loads "6, 30" [N*m]   @param more further keys
    [[nodiscard]] Plot swept(const std::string& loads, const std::string& more = "") const {
        write("sweep.toml",
              "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nstart.state = \"\"\nstart.settling_time = \"20 us\"\n"
              "start.ramp_time = \"10 us\"\n" +
                  more + "[[axes]]\nkey = \"load.torque\"\nvalues = [" + loads +
                  "]\n[[axes]]\nkey = \"start.ratio\"\nvalues = [1, 1.2]\n[outputs]\nscalars = [\"slip mean\"]\n");
        std::filesystem::remove_all(folder_ / "swept");
        const Outcome batch = run({"batch", "sweep.toml", "-q", "-o", "swept"});
        EXPECT_EQ(batch.status, 0) << batch.err;
        return map("swept");
    }
};

TEST_F(Maps, PlaceASpeedRatioLogarithmically) {
    for (const auto& [column, scale] : {std::pair{"start_ratio", Scale::logarithmic},
                                        {"control_ratio", Scale::logarithmic},
                                        {"ratio_mean", Scale::logarithmic},
                                        {"thrust_ratio_mean", Scale::linear},
                                        {"chain_damping_ratio", Scale::linear}}) {
        write("cases.csv", std::string("status,load_torque,") + column + ",slip_mean\nok,10,0.5,1\nok,20,0.5,2\nok,10,2,3\nok,20,2,4\n");
        EXPECT_EQ(map("cases.csv", column).y.scale, scale) << column;
        EXPECT_EQ(map("cases.csv", column).x.scale, Scale::linear);
    }
    write("cases.csv", "status,load_torque,ratio_mean,slip_mean\nok,10,0,1\nok,20,0,2\nok,10,2,3\nok,20,2,4\n");
    EXPECT_EQ(map("cases.csv", "ratio_mean").y.scale, Scale::linear) << "0 has no logarithm";
}

TEST_F(Maps, OverTheLoadHaveTheTorqueLimit) {
    const std::vector<Point> limit = points_of(swept("6, 30"), "torque limit");
    ASSERT_EQ(limit.size(), 2U);
    const double radius = (24 * 8.12e-3 - 2.0 * 47e-3) / (2.0 * std::numbers::pi);  // of both pulleys at ratio 1
    EXPECT_NEAR(limit[0].x, 2.0 * 0.09 * 5700.0 * radius / std::cos(11.0 * std::numbers::pi / 180.0), 1e-9);
    EXPECT_EQ(limit[0].y, 1.0);
    EXPECT_NEAR(limit[1].x / limit[0].x, 1.2 / 1.1, 0.01) << "the sum of the radii hardly changes";
    EXPECT_EQ(limit[1].y, 1.2);
}

TEST_F(Maps, ShowNoTorqueLimitThatNoCaseReaches) {
    EXPECT_THAT(points_of(swept("6, 12"), "torque limit"), testing::IsEmpty()) << "beyond the loads";
    EXPECT_THAT(points_of(swept("6, 30", "clamping.safety = 1.3\n"), "torque limit"), testing::IsEmpty()) << "the clamping force follows";
}

TEST_F(Maps, TheTorqueLimitOfALoadBelowZeroIsBelowZero) {
    const std::vector<Point> above = points_of(swept("6, 30"), "torque limit"), below = points_of(swept("-30, -6"), "torque limit");
    ASSERT_EQ(below.size(), above.size());
    for (std::size_t k = 0; k < above.size(); ++k) EXPECT_DOUBLE_EQ(below[k].x, -above[k].x);
}

/// The axes end where the cases do, although the line continues.
TEST_F(Maps, TheTorqueLimitSetsNoEnds) {
    const Plot plot = swept("6, 17");
    const auto line = std::ranges::find(plot.series, "torque limit", &Series::name);
    ASSERT_NE(line, plot.series.end());
    EXPECT_GT(line->points[1].x, 17.0);
    Plot without = plot;
    std::erase_if(without.series, [](const Series& series) { return series.name == "torque limit"; });
    const auto ticks = [](const std::string& svg) {
        return svg.substr(svg.find("class=\"x\""), svg.rfind("class=\"x\"") - svg.find("class=\"x\""));
    };
    EXPECT_EQ(ticks(svg(plot)), ticks(svg(without)));
}

TEST_F(Maps, MarkVerifiedCases) {
    const std::string cases = "\nok,10,1,0.1,nan,1\nok,20,1,0.2,0.03,1\nok,10,2,0.3,nan,1\nok,20,2,0.4,nan,1\n";
    write("cases.csv", "status,load_torque,start_ratio,slip_mean,error_of_slip_mean,wall" + cases);
    const std::vector<Point> marked = points_of(map("cases.csv"), "verified");
    ASSERT_EQ(marked.size(), 1U);
    EXPECT_EQ(marked[0].x, 20.0);
    EXPECT_EQ(marked[0].y, 1.0);
    write("cases.csv", "status,load_torque,start_ratio,slip_mean,error_of_slip_mean,settled_for" + cases);
    EXPECT_THAT(points_of(map("cases.csv"), "verified"), testing::IsEmpty()) << "errors of means that are steady";
}

}  // namespace
}  // namespace cvtflow::tools
