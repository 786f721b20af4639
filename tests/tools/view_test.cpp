/// Parts of pictures and pages: figures of channels, and the torque limits of a sweep's cases.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "tests/tools/program_fixture.hpp"
#include "tools/program/view/recorded_run.hpp"
#include "tools/program/view/sweep_view.hpp"

namespace cvtflow::tools {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();

TEST(FiniteFigures, LeaveOutWhatIsUndefined) {
    const FiniteFigures figures(std::vector{none, 3.0, 1.0, endless, 2.0, none});
    EXPECT_EQ(figures.mean, 2.0);
    EXPECT_EQ(figures.least, 1.0);
    EXPECT_EQ(figures.largest, 3.0);
}

TEST(FiniteFigures, AreUndefinedWhereNothingIsFinite) {
    for (const std::vector<double>& numbers : {std::vector<double>{}, {none, none}, {endless}}) {
        const FiniteFigures figures(numbers);
        EXPECT_TRUE(std::isnan(figures.mean) && std::isnan(figures.least) && std::isnan(figures.largest)) << numbers.size();
    }
}

class TorqueLimits : public Program {
protected:
    /// Limits of four cases of tiny over load and ratio. @param loads "6, 30" [N*m]   @param more further keys
    [[nodiscard]] std::vector<std::optional<double>> swept(const std::string& loads, const std::string& more = "") const {
        write("sweep.toml",
              "[sweep]\nscene = \"tiny\"\n[set]\nrun.until = \"20 us\"\nstart.state = \"\"\nstart.settling_time = \"20 us\"\n"
              "start.ramp_time = \"10 us\"\n" +
                  more + "[[axes]]\nkey = \"load.torque\"\nvalues = [" + loads +
                  "]\n[[axes]]\nkey = \"start.ratio\"\nvalues = [1, 1.2]\n[outputs]\nscalars = [\"slip mean\"]\n");
        std::filesystem::remove_all(folder_ / "swept");
        const Outcome batch = run({"batch", "sweep.toml", "-q", "-o", "swept"});
        EXPECT_EQ(batch.status, 0) << batch.err;
        const SweepView sweep = read_sweep((folder_ / "swept").string());
        std::vector<std::optional<double>> limits;
        for (std::size_t row = 0; row < sweep.cells.size(); ++row) limits.push_back(load_limit(sweep, row));
        return limits;
    }
};

TEST_F(TorqueLimits, AreThoseOfCoulombOnTheDrivenPulleyOnTheSideOfTheLoad) {
    const auto limits = swept("6, -30");
    ASSERT_EQ(limits.size(), 4U);
    const double radius = (24 * 8.12e-3 - 2.0 * 47e-3) / (2.0 * std::numbers::pi);  // of both pulleys at ratio 1
    EXPECT_NEAR(*limits[0], 2.0 * 0.09 * 5700.0 * radius / std::cos(11.0 * std::numbers::pi / 180.0), 1e-9);
    EXPECT_NEAR(*limits[1] / *limits[0], 1.2 / 1.1, 0.01) << "the sum of the radii hardly changes";
    EXPECT_DOUBLE_EQ(*limits[2], -*limits[0]);
}

TEST_F(TorqueLimits, AreNoneWhereTheClampingForceFollowsTheLoad) {
    for (const auto& limit : swept("6, 30", "clamping.safety = 1.3\n")) EXPECT_FALSE(limit);
}

}  // namespace
}  // namespace cvtflow::tools
