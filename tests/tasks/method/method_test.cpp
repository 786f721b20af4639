/// Methods of runs: what they state, the meaning of run.method = "auto", by detail and friction law (it is resolved wherever a method is
/// named), and the revisions by which checkpoints guard methods that are programs; the results of each are recorded here.

#include "tasks/method/method.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "engine/base/hash.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/scene.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::tasks {
namespace {

TEST(MethodChoice, WhatProgramsSayOfTheirErrorIsWhatTheyDo) {
    const Scene halves = read_scene(CVTFLOW_SOURCE_DIR "/scenes/tiny.toml");
    Scene rigid = halves;
    apply_detail(rigid, "rigid");
    int estimating = 0;
    for (const MethodProgram& program : method_programs()) {
        const Scene& scene = program.objection(halves.parameters).empty() ? halves : rigid;
        Workspace workspace(scene.parameters, Method(program.name).plan(), Partition::equal(scene.parameters.chain.pins, 1));
        EXPECT_EQ(Method(program.name).estimates_error(), Method(program.name).make(workspace)->error_estimate().power != 0)
            << program.name;
        estimating += program.estimates_error;
    }
    EXPECT_GE(estimating, 1);  // dumka3, which follows the spectrum, at least
}

TEST(MethodChoice, TablesEstimateTheirErrorIfTheyHoldAnEstimate) {
    EXPECT_TRUE(Method("dopri54").estimates_error());
    EXPECT_FALSE(Method("rk4").estimates_error());
    EXPECT_TRUE(Method("dumka3-p3").estimates_error());
}

std::string automatic_with(const std::vector<std::string>& settings) {
    return method_of(scene_of("tiny", "", {"start.settling_time=0", "start.ramp_time=1us", "run.method=auto"}, settings));
}

/// A tenth of the usual saturation speeds takes five sweeps; a thousandth would take more than a step has.
TEST(AutomaticMethod, IsChosenByDetailFrictionLawAndSaturationSpeeds) {
    using Settings = std::vector<std::string>;
    for (const auto& [settings, method] :
         {std::pair{Settings{}, "leapfrog-sweep"},
          {{"detail.plates=each", "detail.joint_points=8"}, "leapfrog-sweep"},
          {{"detail.pins=rigid"}, "leapfrog-rigid"},
          {{"detail.pins=rigid", "detail.friction=smoothed"}, "leapfrog-rigid"},
          {{"detail.friction=smoothed"}, "dumka3"},
          {{"detail.stick_slip=true"}, "dumka3"},
          {{"tip.saturation_speed=1e-3", "joint.saturation_speed=5e-4", "plate.saturation_speed=1e-3"}, "leapfrog-sweep"},
          {{"tip.saturation_speed=1e-5"}, "dumka3"},
          {{"chain.pins=11", "detail.pulleys=absent", "start.layout=ring"}, "rk4"}})
        EXPECT_EQ(automatic_with(settings), method) << testing::PrintToString(settings);
}

TEST(AutomaticMethod, HasRowsOfTheCatalogueOfWhichTheLastSuitsEveryMachine) {
    const auto rows = automatic_choices();
    for (const AutomaticChoice& row : rows) EXPECT_TRUE(may_be_method(row.method)) << row.method;
    model::Parameters odd;
    odd.detail.friction = model::FrictionLaw::smoothed;
    odd.detail.stick_slip = true;
    EXPECT_TRUE(rows.back().suits(odd));
    for (const AutomaticChoice& row : rows) {
        if (!row.suits(odd)) continue;
        EXPECT_EQ(objection_to(row.method, odd), "") << row.method;
    }
}

TEST(AutomaticMethod, NamesThatAreGivenStay) {
    EXPECT_EQ(resolved_method("rk4", {}), "rk4");
    EXPECT_EQ(resolved_method("no such method", {}), "no such method") << "refused where methods are made";
}

/// Results are bitwise those of the method that it represents, and are known by that name.
TEST(AutomaticMethod, IsResolvedOnceWhenASimulationIsMade) {
    Simulation automatic(claims::ready_scene("baseline", {"run.method=auto", "run.schedule=serial"}));
    Simulation named(claims::ready_scene("baseline", {"run.method=leapfrog-sweep", "run.schedule=serial"}));
    EXPECT_EQ(automatic.method().name(), "leapfrog-sweep");
    for (Simulation* each : {&automatic, &named}) settle_and_go(*each, 50e-6);
    EXPECT_EQ(automatic.hash(), named.hash());
}

/// A simulation whose memory another scene takes over is of one method.
TEST(AutomaticMethod, DecidesWhetherAnotherSceneFits) {
    const Simulation simulation(claims::ready_scene("baseline", {"run.schedule=serial"}));
    EXPECT_TRUE(fits(simulation, claims::ready_scene("baseline", {"run.method=leapfrog-sweep"})));
    EXPECT_FALSE(fits(simulation, claims::ready_scene("baseline", {"detail.friction=smoothed"})));
}

/// Hash of the state after some steps of tiny as it settles; "none" where the method does not take the machine.
[[nodiscard]] std::string course_of(const std::string& method, const char* detail) {
    Scene scene = scene_of("tiny", detail);
    scene.run.method = method;
    scene.run.schedule = "serial";
    scene.run.step = scene.parameters.detail.pins == model::PinDetail::rigid ? 1e-6 : 5e-8;
    if (!objection_to(method, scene.parameters).empty()) return "none";
    Simulation simulation(scene);
    (void)go(simulation, {.steps = 40, .new_part = true, .max_wall = 0.0});
    return engine::hex(simulation.hash());
}

struct Recorded {
    const char* method;
    int revision;
    const char *fine, *rigid;  ///< hashes
};
constexpr Recorded recorded[] = {
    {"dumka3", 1, "a70dfff64c047984", "7d25c1bcfba3af3e"},
    {"rkc", 1, "7c9ac806a0677b62", "42cd1775ba8ea18a"},
    {"fitted", 1, "d47c039b512c6467", "0b87fafcd4415de9"},
    {"leapfrog-sweep", 6, "d03e220f7159e004", "none"},
    {"leapfrog-rigid", 4, "none", "b01090cd8ebb37c9"},
    {"trapezoidal-analytic", 2, "75858bb6f14f2039", "none"},
    {"trapezoidal-full", 2, "891228d1b526264f", "none"},
    {"trapezoidal-once", 2, "923ab37b53bdafd0", "none"},
    {"trapezoidal-frozen", 2, "97770e395c317b2d", "none"},
    {"trapezoidal-broyden", 2, "5be8f9280901ea01", "none"},
    {"trapezoidal-schubert", 2, "b777af65a44c1b64", "none"},
    {"trapezoidal-plain", 2, "0173f11f0fd26514", "none"},
    {"sw2", 2, "3d181bfbda2efee1", "none"},
    {"ros34pw2", 2, "c0545ab8fef58948", "none"},
    {"w-x2", 2, "bd71ad2675b458d2", "none"},
    {"w-x3", 2, "56844f956116462e", "none"},
    {"w-x4", 2, "203bc4ce424255b3", "none"},
};

/// If a hash differs on purpose, by the method and not by the right-hand side: raise the method's revision and record both here. Else the
/// method computes otherwise unintended.
TEST(MethodRevision, IsRaisedWhereAMethodComputesOtherwise) {
    for (const MethodProgram& program : method_programs()) {
#ifdef __FMA__
        if (program.name == "fitted") continue;  // Eigen fits other polynomials with fused multiply-adds (DECISIONS 70)
#endif
        const auto known = std::ranges::find_if(recorded, [&](const Recorded& each) { return program.name == each.method; });
        const std::string now = fmt::format("{{\"{}\", {}, \"{}\", \"{}\"}},", program.name, program.revision,
                                            course_of(program.name, "fine"), course_of(program.name, "rigid"));
        if (known == std::end(recorded)) {
            ADD_FAILURE() << "record " << now;
            continue;
        }
        EXPECT_EQ(now, fmt::format("{{\"{}\", {}, \"{}\", \"{}\"}},", known->method, known->revision, known->fine, known->rigid));
    }
}

}  // namespace
}  // namespace cvtflow::tasks
