/// Cases that were once wrong with status ok. Every row is right with the automatic step, and not reported as finished at 2 us. Right
/// values come from runs with steps of 0.5 us.

#include <gtest/gtest.h>

#include "tasks/run/run.hpp"
#include "tasks/scene/ready_scenes.hpp"

namespace cvtflow::tasks {
namespace {

struct Row {
    std::string scene;
    std::vector<std::string> settings;
    std::string detail;
    bool wrong_at_2us;  ///< else 2 us is right by itself, to a per cent
};

const std::vector<Row>& rows() {
    static const std::vector<Row> all{
        {"control", {}, "", true},
        {"shift", {}, "", true},
        {"load_ramp", {}, "", false},
        {"baseline", {"clamping.driven=30 kN", "clamping.driving=40.65 kN"}, "medium", true},
        {"baseline", {"clamping.driven=40 kN", "clamping.driving=54.2 kN"}, "medium", true},
        {"baseline", {"joint.stiffness=1.4e9"}, "", true},
        {"baseline", {"half.mass=3.5 g"}, "", true},
        {"baseline", {"chain.damping_ratio=0.05"}, "", true},
        {"baseline", {"clamping.driven=60 kN", "clamping.driving=81.3 kN"}, "", true},
        {"baseline", {"clamping.driven=80 kN", "clamping.driving=108.4 kN"}, "", true},
        {"baseline", {"joint.law=palmgren", "clamping.driven=50 kN", "clamping.driving=67.75 kN"}, "", true},
        {"baseline", {"pulley.sheave_mass=0.3 kg"}, "", true},
        {"baseline", {"pulley.cylinder_damping=1.4e6"}, "", true},
        {"baseline", {"detail.order=0", "detail.plates=lumped", "detail.joint_points=1", "detail.pulleys=rigid", "start.state="}, "", true},
    };
    return all;
}

RunReport run_row(const Row& row, const std::string& step) {
    Scene scene = read_scene(find_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/" + row.scene + ".toml"));
    if (!row.detail.empty()) {
        apply_detail(scene, row.detail);
        scene.state_file.clear();
    }
    std::vector<std::string> settings = row.settings;
    settings.insert(settings.end(), {"run.method=leapfrog-chebyshev", "run.step=" + step, "run.until=20 ms", "run.schedule=serial"});
    set_values(scene, settings);
    return run_scene(scene, {});
}

std::string name_of(const Row& row) { return row.scene + " " + row.detail + (row.settings.empty() ? "" : " " + row.settings.back()); }

void check(const Row& row) {
    const RunReport automatic = run_row(row, "auto"), exact = run_row(row, "0.5 us"), hasty = run_row(row, "2 us");
    EXPECT_EQ(automatic.status(), "finished") << name_of(row) << ": balance error ratio " << automatic.balance_error_ratio;
    EXPECT_EQ(exact.status(), "finished") << name_of(row) << ": balance error ratio " << exact.balance_error_ratio;
    EXPECT_NEAR(automatic.whole.slip, exact.whole.slip, 0.01 * exact.whole.slip) << name_of(row);
    EXPECT_NEAR(automatic.whole.efficiency, exact.whole.efficiency, 5e-4) << name_of(row);  // a percent of losses of some per cent
    const bool right = std::abs(hasty.whole.slip - exact.whole.slip) <= 0.01 * exact.whole.slip &&
                       std::abs(hasty.whole.efficiency - exact.whole.efficiency) <= 5e-4;
    EXPECT_TRUE(right || hasty.status() != "finished") << name_of(row) << ": 2 us ends as " << hasty.status();
    if (!right) {
        EXPECT_TRUE(row.wrong_at_2us) << name_of(row) << ": the row is out of date";
    }
}

/// Three rows in every run: a shipped scene, a level of detail, a machine.
TEST(Reliability, OfSettingsThatWereOncePrintedWrong) {
    for (const std::size_t row : {0U, 3U, 7U}) check(rows()[row]);
}

TEST(NightlyReliability, OfEverySettingThatWasOncePrintedWrong) {
    for (const Row& row : rows()) check(row);
}

/// Machines whose chain is another one than the ready state's: each was called finished with the slip of a chain that snaps into place.
void expect_settled_anew(const std::vector<std::string>& settings) {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/baseline.toml");
    set_values(scene, settings);
    set_values(scene, std::vector<std::string>{"run.method=leapfrog-chebyshev", "run.until=12 ms", "run.schedule=serial",
                                               "start.settling_time=20 ms"});
    const RunReport ready = run_scene(scene, {});
    scene.state_file.clear();
    const RunReport own = run_scene(scene, {});
    EXPECT_EQ(ready.status(), "finished") << settings.front() << ": balance error ratio " << ready.balance_error_ratio;
    EXPECT_TRUE(ready.settled) << settings.front();
    EXPECT_EQ(ready.hash, own.hash) << settings.front();
}

TEST(Reliability, OfAReadyStateWhoseChainIsAnotherOne) { expect_settled_anew({"chain.pitch=[\"8.12 mm\",\"8.42 mm\",\"7.82 mm\"]"}); }

TEST(NightlyReliability, OfEveryReadyStateWhoseChainIsAnotherOne) {
    expect_settled_anew({"chain.pitch=[\"8.12 mm\",\"8.22 mm\",\"8.02 mm\"]"});
    expect_settled_anew({"chain.pitch=[\"8.12 mm\",\"8.82 mm\",\"7.42 mm\"]"});
    expect_settled_anew({"chain.pitch=8.3 mm"});
    expect_settled_anew({"half.width=2.2 mm"});
    expect_settled_anew({"pulley.centre_distance=171 mm"});
}

/// 8 ms of baseline with a jump in the middle of a step.
RunReport run_with_jump(const std::string& jump, std::vector<std::string> settings) {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/baseline.toml");
    settings.insert(settings.end(), {jump, "run.until=8 ms", "run.schedule=serial"});
    set_values(scene, settings);
    return run_scene(scene, {});
}

const std::string reversal = "load.torque=[[0,\"150 N*m\"],[\"5.0004 ms\",\"150 N*m\"],[\"5.0014 ms\",\"-150 N*m\"]]";

/// An input that jumps in the middle of a step, and one of the drive: right, and called so.
TEST(Reliability, OfInputsThatJump) {
    for (const std::string& jump :
         {reversal, std::string("drive.speed=[[0,\"2000 rpm\"],[\"5.0004 ms\",\"2000 rpm\"],[\"5.0014 ms\",\"2100 rpm\"]]")}) {
        const RunReport report = run_with_jump(jump, {});
        EXPECT_EQ(report.status(), "finished") << jump << ": balance error ratio " << report.balance_error_ratio;
        EXPECT_LT(report.energy.relative(), 2e-3);  // a fifth of what is called wrong
    }
}

/// Friction in stages answers a reversed load with losses that scatter by 2 % from step to step (1.1 to 1.5 us): those that are off are
/// said.
TEST(Reliability, OfLossesThatAreOffAfterAJumpIsNone) {
    const double right = run_with_jump(reversal, {"run.step=1 us"}).energy.loss;
    const RunReport report = run_with_jump(reversal, {"run.method=leapfrog-chebyshev", "run.step=1.25 us"});
    EXPECT_GT(std::abs(report.energy.loss / right - 1.0), 0.01);
    EXPECT_EQ(report.status(), "unreliable");
}

/// RK4 at 50 ns was the published reference; its joints chatter. At its automatic step the balance closes to 1e-5.
TEST(Reliability, OfThePublishedStepIsNone) {
    Scene scene = read_scene(std::string(CVTFLOW_SOURCE_DIR) + "/scenes/baseline.toml");
    set_values(scene, std::vector<std::string>{"run.method=rk4", "run.step=54 ns", "run.until=3 ms", "run.schedule=serial"});
    EXPECT_EQ(run_scene(scene, {}).status(), "unreliable");
    set_values(scene, std::vector<std::string>{"run.step=auto", "run.until=1 ms"});
    const RunReport report = run_scene(scene, {});
    EXPECT_EQ(report.status(), "finished");
    EXPECT_LT(report.energy.relative(), 1e-4);
}

}  // namespace
}  // namespace cvtflow::tasks
