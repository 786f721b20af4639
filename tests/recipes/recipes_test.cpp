/// Worked examples of the recipes in CONTRIBUTING (force_test.cpp apart, which compiles other kernels), each in steps of the default, and
/// the files that recipes name.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "bench/method/analysis/order.hpp"
#include "engine/executor/catalogue.hpp"
#include "engine/executor/run.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tests/tasks/run/settled_run_fixture.hpp"

namespace cvtflow::recipes {
namespace {

namespace fs = std::filesystem;

/// The default's step at a level of detail: rigid pins, or halves whose friction is solved in sweeps.
tasks::Scene scene_at(const char* level) {
    return tasks::scene_of("tiny", level, {"start.settling_time=20 us", "start.ramp_time=10 us", "run.method=auto", "run.step=1 us"});
}
std::uint64_t hash_of(const tasks::Scene& scene, const tasks::Schedule& schedule) {
    tasks::Simulation simulation(scene, schedule);
    tasks::settle_and_go(simulation, 2e-5);
    return simulation.hash();
}

// Recipe "an executor": one class, which must run every task once and no task before those that it waits for.

/// Runs the tasks of a level from the last to the first: allowed, since nothing orders them.
class Backward final : public engine::RunningExecutor {
public:
    explicit Backward(const engine::ExecutorOptions& options = {}) : RunningExecutor(options) {}
    [[nodiscard]] std::string_view name() const noexcept override { return "backward"; }

private:
    void execute(engine::Run& run, int first) override {
        for (int cycle = first; cycle != engine::Controller::stop; cycle = run.decide(0)) {
            for (int level = 0; level < run.graph().levels(cycle); ++level) {
                const auto tasks = run.graph().level(cycle, level);
                for (auto task = tasks.rbegin(); task != tasks.rend(); ++task) run.task(*task, 0);
            }
        }
    }
};

TEST(ExecutorRecipe, GivesTheBitsOfTheOthersInTheDefaultsStep) {
    const engine::ExecutorRow row{
        "backward",
        "levels from the last task to the first",
        false,
        engine::Waiting::own,
        {},
        [](const engine::ExecutorOptions& options) -> std::unique_ptr<engine::Executor> { return std::make_unique<Backward>(options); }};
    engine::add_executors({&row, 1});
    for (const auto& [level, segments] : {std::pair{"rigid", 1}, {"fine", 3}}) {  // rigid pins are one segment
        const tasks::Scene scene = scene_at(level);
        EXPECT_EQ(hash_of(scene, {"backward", {tasks::Assembly::fused}, segments, 1}),
                  hash_of(scene, {"serial", {tasks::Assembly::fused}, 1, 1}));
    }
}

// Recipe "a key of scenes": a member and a row of the parameter table, from which reading, units, limits and documents follow.

/// The member represents a new one of the parameters.
const tasks::Parameter toy_length{
    "half.toy_length", "m", 1e-3, 0.1, {}, tasks::of<&model::Half::length>, "Length of nothing, for a recipe.", "recipe"};

TEST(KeyRecipe, ItsRowReadsUnitsAndRefusesOthersAndReachesTheDefaultsStep) {
    tasks::Scene scene = scene_at("rigid");
    const std::uint64_t before = hash_of(scene, {});
    std::vector<tasks::Problem> problems;
    for (const char* wrong : {"3 kg", "500 mm"}) tasks::read_value(toy_length, {std::string(wrong), {}}, scene, problems);
    EXPECT_EQ(problems.size(), 2u);
    EXPECT_EQ(hash_of(scene, {}), before);
    tasks::read_value(toy_length, {std::string("30 mm"), {}}, scene, problems);
    EXPECT_DOUBLE_EQ(scene.parameters.half.length, 0.03);
    EXPECT_NE(hash_of(scene, {}), before);
}

// Recipe "a friction law": one by speed; a table is the last that was added.

TEST(LawRecipe, OfSpeedIsInTheDefaultsStep) {
    for (const char* level : {"rigid", "fine"}) {
        tasks::Scene scene = scene_at(level);
        const std::uint64_t before = hash_of(scene, {});
        scene.parameters.tip.friction_law = model::TipFriction::table;
        scene.parameters.tip.friction_table = {{0.0, 1.0}, {0.09, 0.06}};
        EXPECT_NE(hash_of(scene, {}), before) << level;
    }
}

// Recipe "an explicit method": a table, from which order, stability and stage times are derived.

TEST(MethodRecipe, OrderIsDerivedFromTheTable) {
    const engine::StagePlan ralston = engine::butcher_plan("ralston", "order 2 with the smallest error bound",
                                                           "Ralston, Math. Comp. 16 (1962) 431-437", {{2.0 / 3.0}}, {0.25, 0.75});
    EXPECT_NO_THROW(bench::validate(ralston));
    EXPECT_EQ(bench::order_of(ralston), 2);
    engine::StagePlan wrong = ralston;
    wrong.result.slopes[0].factor = 0.3;  // weights no longer sum to 1
    EXPECT_EQ(bench::order_of(wrong), 0);
}

// The files that recipes name exist, and each recipe has its worked example.

TEST(Recipes, NameFilesThatAreThere) {
    static const std::regex step("[0-9]+\\. `([^`]+)`.*"), example("Worked example: \\[`[^`]+`\\]\\(([^)]+)\\).*"), heading("### Add (.*)");
    std::ifstream file(fs::path(CVTFLOW_SOURCE_DIR) / "CONTRIBUTING.md");
    int recipes = 0, examples = 0;
    for (std::string line; std::getline(file, line);) {
        std::smatch match;
        if (std::regex_match(line, match, heading)) ++recipes;
        const bool names_example = std::regex_match(line, match, example);
        if (recipes == 0 || (!names_example && !std::regex_match(line, match, step))) continue;
        examples += names_example ? 1 : 0;
        EXPECT_TRUE(fs::exists(fs::path(CVTFLOW_SOURCE_DIR) / match[1].str())) << line;
    }
    EXPECT_EQ(recipes, 5);
    EXPECT_EQ(examples, recipes);
}

}  // namespace
}  // namespace cvtflow::recipes
