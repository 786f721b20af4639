#include "tasks/sizing/sizing.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

#include "tests/claims/operating_point_fixture.hpp"

namespace cvtflow::claims {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> outside(std::vector<std::string> settings, double automatic_step = 3e-6) {
    const tasks::Scene scene = ready_scene("baseline", settings);
    return tasks::outside_validity(scene, tasks::size_scene(scene), automatic_step);
}

TEST(Validity, NamesWhatIsOutsideOfTheRangesOfThePage) {
    EXPECT_THAT(outside({}), ElementsAre());
    EXPECT_THAT(outside({"start.ratio=0.46", "load.torque=60", "drive.speed=4900 rpm"}), ElementsAre());
    EXPECT_THAT(outside({"start.ratio=0.43", "load.torque=60"}),
                ElementsAre(HasSubstr("ratio 0.43 is below 0.45"), HasSubstr("shorter arc 10.33")));
    EXPECT_THAT(outside({"drive.speed=[[0, 500], [1, 600]]", "run.until=1"}),
                ElementsAre(HasSubstr("speed of shaft 1 5730 rpm is above 5000")));
    EXPECT_THAT(outside({"load.torque=185"}), ElementsAre(HasSubstr("is above 85 %: slip is known to 1 to 3 %")));
    EXPECT_THAT(outside({"load.torque=20"}), ElementsAre(HasSubstr("is below 35 %: some points have two steady states")));
    EXPECT_THAT(outside({"load.torque=[[0, 20], [1, 100]]", "run.until=1"}), ElementsAre()) << "light loads in passing";
    EXPECT_THAT(outside({"run.step=4 us"}), ElementsAre(HasSubstr("run.step 4 us is longer than the automatic one, 3 us")));
    EXPECT_THAT(outside({"pulley.attachment_tilt=2e8"}), ElementsAre(HasSubstr("pulley.attachment_tilt 2e+08")));
    EXPECT_THAT(outside({"tip.friction_law=lubricated"}), ElementsAre(HasSubstr("friction falls")));
}

TEST(Validity, JudgesForcesAndSmallLoadsAtTheLevelRigid) {
    const std::vector<std::string> light{"load.torque=5", "clamping.driven=41 kN"};
    EXPECT_EQ(outside(light).size(), 1U);
    EXPECT_THAT(
        outside({light[0], light[1], "detail.level=rigid"}),
        ElementsAre(HasSubstr("S_2 41 kN is above 40 kN"), HasSubstr("is below 35 %"), HasSubstr("is below 5 %: losses of joints")));
}

TEST(Validity, HasTheFiguresOfThePage) {
    std::ifstream file(CVTFLOW_SOURCE_DIR "/docs/validity.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    for (const char* figure :
         {"ratio 0.45 to 2.3", "700 to 5000 rpm", "8 to 40 kN", "0.4e6 to 1e8", "10.4 pins", "above 85 %", "below 35 %", "below 5 %"})
        EXPECT_THAT(page, HasSubstr(figure));
}

}  // namespace
}  // namespace cvtflow::claims
