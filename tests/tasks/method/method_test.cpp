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
          {{"detail.friction=smoothed"}, "leapfrog-sweep"},
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
    EXPECT_FALSE(fits(simulation, claims::ready_scene("baseline", {"detail.stick_slip=true"})));
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
    {"dumka3", 1, "baf82f55ea705577", "cc0238ea498e0265"},
    {"rkc", 1, "9e5e9fa373dc02ae", "87dc97a9134ab40c"},
    {"fitted", 1, "2fbdc96ce5cfd7b6", "e70b8b5bf70032da"},
    {"leapfrog-sweep", 7, "7d1032b9805c157c", "none"},
    {"leapfrog-rigid", 5, "none", "7176354b1f617b44"},
    {"trapezoidal-analytic", 2, "b171817759998b90", "none"},
    {"trapezoidal-full", 2, "33601c254f8ac6fe", "none"},
    {"trapezoidal-once", 2, "0b68b0395a999553", "none"},
    {"trapezoidal-frozen", 2, "d8393bf9e967ebe6", "none"},
    {"trapezoidal-broyden", 2, "54ac8786d0e01ae0", "none"},
    {"trapezoidal-schubert", 2, "b7559d9ce584c55e", "none"},
    {"trapezoidal-plain", 2, "415788928894e6bd", "none"},
    {"sw2", 2, "6ffb41825e9681c1", "none"},
    {"ros34pw2", 2, "0ef9a3e31fd154b0", "none"},
    {"w-x2", 2, "8ad063c660770ec0", "none"},
    {"w-x3", 2, "d3c95248d8c22a74", "none"},
    {"w-x4", 2, "e1d2a8bf21e5046d", "none"},
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
