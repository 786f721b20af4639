/// Friction solved for inside a step: slips and forces are those of the friction kernels, what comes out solves the equation of a stage,
/// and the methods on top give the same bits for every schedule.

#include "tasks/method/friction/friction_solve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tasks/method/method.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/step/assembly/segment_tasks.hpp"
#include "tests/claims/method_trial_fixture.hpp"
#include "tests/claims/operating_point_fixture.hpp"
#include "tests/engine/executor/executor_fixture.hpp"
#include "tests/engine/graph/race_check_fixture.hpp"

namespace cvtflow::tasks {
namespace {

const engine::Cancellation never;
const std::vector<std::string> methods{"leapfrog-be", "leapfrog-sdirk2", "ark436", "ars343"};

/// The contacts of a scene's start, as lanes over links for the friction kernels and as groups for the solve.
class Contacts {
public:
    explicit Contacts(const std::vector<std::string>& settings, double g, const std::string& scene = "baseline")
        : scene_(claims::ready_scene(scene, settings)),
          simulation_(scene_),
          links(scene_.parameters.chain.pins),
          workspace_(scene_.parameters, Method("leapfrog-be").plan(), Partition::equal(links, 1)),
          solve(workspace_),
          field_(workspace_.variator.chain()),
          loads_(static_cast<std::size_t>(links)),
          scratch_(static_cast<std::size_t>(friction().scratch_size(links))) {
        std::copy_n(simulation_.state(), layout().size(), workspace_.states[0]);
        if (layout().pulley_size != 0)
            workspace_.variator.pulleys().motions(workspace_.states[0] + layout().pulley_begin(), workspace_.pulleys.sheaves);
        model::Columns frictionless(layout().link_size(), links + 2);
        friction().record(
            {0, links, window_of(workspace_, workspace_.states[0], 0), workspace_.pulleys.sheaves, simulation_.phases().data()}, {}, field_,
            frictionless, loads_.data());
        for (int k = 0; k < solve.groups(); ++k) solve.space().gather(field_, simulation_.phases().data(), g, solve.group(k));
    }

    /// Velocities of the start, each moved by up to `amount`.
    [[nodiscard]] model::Columns velocities(double amount) const {
        model::Columns v(layout().link_size(), links + 2);
        for (int link = 0; link < links; ++link) {
            for (int k = 0; k < layout().link_size(); ++k)
                *v.at(k, link + 1) = workspace_.states[0][layout().link_begin(link) + layout().link_size() + k] +
                                     amount * std::sin(1.0 + 2.399 * link + 0.7 * k);
        }
        repeat(v);
        return v;
    }
    /// Accelerations by friction, from the friction kernels.
    [[nodiscard]] model::Columns accelerations(model::Columns& v) {
        repeat(v);
        model::Columns a(layout().link_size(), links + 2);
        friction().slopes(field_, {0, links, v.data(), v.stride(), scratch_.data(), simulation_.phases().data(), 0.0}, {nullptr, &a});
        return a;
    }
    /// Slips of these velocities, each link's part into `rows`.
    void slips(const model::Columns& v, model::LaneRows model::SlipGroup::*rows) {
        for (int k = 0; k < solve.groups(); ++k) {
            model::SlipGroup& g = solve.group(k);
            for (const auto& [link, lane] : g.links) {
                for (int row = 0; row < layout().link_size(); ++row) g.velocity.at(row)[lane] = *v.at(row, link + 1);
            }
            solve.space().slips(0.0, g, g.*rows);
        }
    }
    /// Whole slips from the `own` parts.
    void assemble() {
        for (int k = 0; k < solve.groups(); ++k) solve.assemble(k, solve.group(k).slip);
    }
    /// All cycles of a solve, one after the other. @return what it ended with
    NextCycle run() {
        NextCycle next = solve.begin(0.0);
        for (; !next.is_done() && !next.has_failed(); next = solve.next()) {
            const auto each = [&](void (FrictionSolve::*body)(int) noexcept) {
                for (int k = 0; k < solve.groups(); ++k) (solve.*body)(k);
            };
            if (next.cycle() == iterate_cycle) {
                each(&FrictionSolve::eliminate);
                solve.join();
                each(&FrictionSolve::substitute);
            }
            each(&FrictionSolve::search);
        }
        for (int k = 0; k < solve.groups(); ++k) solve.settle(k);
        return next;
    }
    [[nodiscard]] const model::ChainLayout& layout() const { return workspace_.layout(); }

private:
    [[nodiscard]] const model::FrictionOperator& friction() const { return solve.space().friction(); }
    void repeat(model::Columns& v) const {
        for (int row = 0; row < layout().link_size(); ++row) {
            *v.at(row, 0) = *v.at(row, links);
            *v.at(row, links + 1) = *v.at(row, 1);
        }
    }

    Scene scene_;
    Simulation simulation_;

public:
    int links;

private:
    Workspace workspace_;

public:
    FrictionSolve solve;

private:
    model::ContactField field_;
    std::vector<model::LinkLoad> loads_;
    std::vector<double> scratch_;
};

const std::vector<std::vector<std::string>> details{
    {"detail.joint_points=3"}, {"detail.joint_points=1"}, {"detail.joint_points=5"}, {"detail.friction=smoothed"}};

/// Two independent ways from velocities to accelerations. Tangents are taken at right angles to a tip's normal, which the equations scale
/// by 1 + τ²/2 of the sheave's tilt τ: a part in a million.
TEST(SlipSpace, GivesTheAccelerationsOfTheFrictionKernels) {
    for (const auto& settings : details) {
        Contacts contacts(settings, 1e-6);
        for (const double amount : {0.0, 1e-3, 0.1}) {
            model::Columns v = contacts.velocities(amount);
            const model::Columns expected = contacts.accelerations(v);
            contacts.slips(v, &model::SlipGroup::own);
            contacts.assemble();
            double error = 0.0, size = 0.0;
            for (int k = 0; k < contacts.solve.groups(); ++k) {
                model::SlipGroup& g = contacts.solve.group(k);
                contacts.solve.space().forces(g);
                contacts.solve.space().accelerate(g);
                for (const auto& [link, lane] : g.links) {
                    for (int row = 0; row < contacts.layout().link_size(); ++row) {
                        error = std::max(error, std::abs(g.acceleration.at(row)[lane] - *expected.at(row, link + 1)));
                        size = std::max(size, std::abs(*expected.at(row, link + 1)));
                    }
                }
            }
            EXPECT_GT(size, 1e3);
            EXPECT_LT(error, 2e-6 * size) << settings.front() << " " << amount;
        }
    }
}

/// v - v̂ = g a(v) with a(v) of the friction kernels, from slips far from the solution, in so many iterations at most.
void expect_solution(const std::vector<std::string>& settings, double g, double amount, int iterations,
                     const std::string& scene = "baseline") {
    Contacts contacts(settings, g, scene);
    const std::string title = settings.front() + " g = " + std::to_string(1e6 * g) + "e-6, " + std::to_string(amount) + ": ";
    const model::Columns far = contacts.velocities(10.0 * amount), before = contacts.velocities(amount);
    contacts.slips(far, &model::SlipGroup::own);
    contacts.assemble();
    contacts.slips(before, &model::SlipGroup::predicted);
    ASSERT_TRUE(contacts.run().is_done()) << title;
    EXPECT_LE(contacts.solve.statistics().most, iterations) << title;
    EXPECT_EQ(contacts.solve.statistics().unconverged, 0) << title << text(contacts.solve.statistics());
    model::Columns v(contacts.layout().link_size(), contacts.links + 2);
    for (int k = 0; k < contacts.solve.groups(); ++k) {
        model::SlipGroup& group = contacts.solve.group(k);
        contacts.solve.space().accelerate(group);
        for (const auto& [link, lane] : group.links) {
            for (int row = 0; row < contacts.layout().link_size(); ++row)
                *v.at(row, link + 1) = *before.at(row, link + 1) + g * group.acceleration.at(row)[lane];
        }
    }
    const model::Columns a = contacts.accelerations(v);
    double error = 0.0, size = 0.0;
    for (int link = 1; link <= contacts.links; ++link) {
        for (int row = 0; row < contacts.layout().link_size(); ++row) {
            error = std::max(error, std::abs(*v.at(row, link) - *before.at(row, link) - g * *a.at(row, link)));
            size = std::max(size, std::abs(*v.at(row, link) - *before.at(row, link)));
        }
    }
    EXPECT_GT(size, 0.0) << title;
    EXPECT_LT(error, 1e-4 * size + 1e-9) << title << size;
}

TEST(FrictionSolve, SolvesTheEquationOfAStageWhateverItStartsFrom) {
    for (const auto& settings : details) {
        for (const double g : {1e-7, 2e-6}) {
            for (const double amount : {0.0, 1e-2, 1.0}) expect_solution(settings, g, amount, 40);
        }
    }
}

/// Fewer links than lanes, stretches of unequal length, odd numbers of joints that are left; with a wrong matrix Newton's method would take
/// more iterations.
TEST(FrictionSolve, SolvesForChainsOfAnyLength) {
    for (const int links : {6, 7, 12, 16, 17, 31, 33, 50}) {
        expect_solution({"chain.pins=" + std::to_string(links)}, 2e-6, 1e-2, 10, "free_ring");
        expect_solution({"chain.pins=" + std::to_string(links), "detail.joint_points=2"}, 2e-6, 1.0, 10, "free_ring");
    }
}

TEST(FrictionSolve, SaysHowItFared) {
    EXPECT_EQ(text(SolveStatistics{.solves = 4, .iterations = 10, .most = 5, .searches = 2}),
              "2.50 iterations per friction solve (max 5), 0.50 searches");
    EXPECT_EQ(
        text(SolveStatistics{.solves = 4, .iterations = 10, .most = 50, .searches = 2, .continued = 3, .unconverged = 1, .worst = 2e-4}),
        "2.50 iterations per friction solve (max 50), 0.50 searches, 3 solves by continuation from higher saturation speeds; 1 of 4 solves "
        "did not converge and used the last iterate (residual up to 0.0002 m/s)");
}

/// A finer step is not spoiled by what a solve leaves.
TEST(FrictionSolve, LeavesLessInShorterSteps) {
    EXPECT_EQ(FrictionSolve::tolerance(5e-6), FrictionSolve::tolerance(2e-6));
    EXPECT_NEAR(FrictionSolve::tolerance(1e-6) / FrictionSolve::tolerance(2e-6), 0.25, 1e-12);
    EXPECT_EQ(FrictionSolve::tolerance(1e-12), FrictionSolve::min_tolerance);
}

/// Tolerances are no saturation speeds: at a thousandth of the usual ones friction is Coulomb's but for 5 to 10 µm/s.
TEST(FrictionImplicit, ConvergesHoweverLowSaturationSpeedsAre) {
    for (const std::string& method : methods) {
        for (const double factor : {1.0, 0.1, 0.01, 0.001}) {
            const auto speed = [&](double usual) { return std::to_string(usual * factor * 1e9) + "e-9"; };
            const Scene scene = claims::ready_scene(
                "baseline",
                {"joint.saturation_speed=" + speed(5e-3), "plate.saturation_speed=" + speed(1e-2), "tip.saturation_speed=" + speed(1e-2)});
            const bool leapfrog = method.starts_with("leapfrog");
            const bench::TrialEnd end =
                bench::try_method(scene.parameters, frozen_start(Simulation(scene)), method, 1e-6, leapfrog ? 50e-6 : 10e-6);
            EXPECT_FALSE(end.fault) << method << " " << factor;
            EXPECT_GE(end.counters.steps, leapfrog ? 50 : 10);
            EXPECT_EQ(end.report.find("did not converge"), std::string::npos) << method << " " << factor << ": " << end.report;
        }
    }
}

std::uint64_t hash_of(const std::vector<std::string>& settings) {
    Simulation simulation(claims::ready_scene("baseline", settings));
    SilentObserver nobody;
    EXPECT_FALSE(simulation.advance({.until = 40e-6}, nobody, never)) << settings.back();
    EXPECT_GT(simulation.counters().steps, 19);
    return simulation.hash();
}

TEST(FrictionImplicit, GivesTheSameBitsForEverySchedule) {
    for (const std::string& method : methods) {
        const auto with = [&](std::vector<std::string> more) {
            more.insert(more.begin(), {"run.method=" + method, "run.step=2us"});
            return hash_of(more);
        };
        const std::uint64_t serial = with({"run.schedule=serial"});
        EXPECT_EQ(with({"run.schedule=barrier", "run.threads=2", "run.segments=3"}), serial) << method;
        EXPECT_EQ(with({"run.schedule=barrier", "run.assembly=staged", "run.threads=2", "run.segments=5"}), serial) << method;
        if (engine::test::thread_sanitizer) continue;  // it sees into neither oneTBB nor OpenMP
        EXPECT_EQ(with({"run.schedule=flow", "run.threads=2", "run.segments=7"}), serial) << method;
        EXPECT_EQ(with({"run.schedule=flow_messages", "run.threads=2", "run.segments=2"}), serial) << method;
        EXPECT_EQ(with({"run.schedule=serial", "run.segments=84"}), serial) << method;
    }
}

TEST(FrictionImplicit, GivesTheSameBitsForEveryInstructionSet) {
    const char* before = std::getenv("CVTFLOW_ISA");
    const std::string kept = before == nullptr ? "auto" : before;
    for (const std::string& method : methods) {
        for (const char* points : {"2", "3"}) {
            const auto with = [&](model::Isa isa) {
                setenv("CVTFLOW_ISA", std::string(model::name_of(isa)).c_str(), 1);
                return hash_of(
                    {"run.method=" + method, "run.step=2us", "run.schedule=serial", std::string("detail.joint_points=") + points});
            };
            for (const model::Isa isa : model::usable_isas())
                EXPECT_EQ(with(isa), with(model::Isa::baseline)) << method << " " << points << " " << model::name_of(isa);
        }
    }
    setenv("CVTFLOW_ISA", kept.c_str(), 1);
}

TEST(FrictionImplicit, ItsGraphHasNoRaces) {
    for (const std::string& method : methods) {
        const Scene scene = claims::ready_scene("baseline", {"run.method=" + method});
        for (const int segments : {1, 2, 5, 84}) {
            Workspace workspace(scene.parameters, Method(method).plan(), Partition::equal(84, segments));
            const auto steps = Method(method).at_work(workspace);
            for (const Assembly assembly : {Assembly::fused, Assembly::staged}) {
                EXPECT_TRUE(engine::race_check(step_graph(workspace, {.kind = assembly}, steps.get())).empty())
                    << method << " " << segments;
            }
        }
    }
}

}  // namespace
}  // namespace cvtflow::tasks
