/// Worked examples of the recipes in CONTRIBUTING (force_test.cpp apart, which compiles other kernels), and the files that recipes name.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "bench/method/analysis/order.hpp"
#include "bench/method/implicit/linear_plan.hpp"
#include "engine/executor/run.hpp"
#include "engine/graph/task_graph.hpp"
#include "engine/method/stage_plan.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/method/method.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/toml_tree.hpp"
#include "tests/claims/rig_fixture.hpp"
#include "tests/lab/method/jacobian/dual_law_properties.hpp"
#include "tests/tasks/tiny_fixture.hpp"

namespace cvtflow::recipes {
namespace {

namespace fs = std::filesystem;
using model::FrictionCurve;
using model::Lanes;

// Recipe "an explicit method": a table, from which order, stability and stage times are derived.

/// A file of engine/method contains one function like this. Ralston's method, with the smallest error bound of all of order 2 and two
/// stages.
engine::StagePlan ralston() {
    return engine::butcher_plan("ralston", "order 2 with the smallest error bound", "Ralston, Math. Comp. 16 (1962) 431-437", {{2.0 / 3.0}},
                                {0.25, 0.75});
}

TEST(MethodRecipe, OrderIsDerivedFromTheTable) {
    const engine::StagePlan plan = ralston();
    EXPECT_NO_THROW(bench::validate(plan));
    EXPECT_EQ(bench::order_of(plan), 2);
    EXPECT_EQ(plan.stages.size(), 2u);
}

TEST(MethodRecipe, AWrongTableIsFoundOut) {
    engine::StagePlan wrong = ralston();
    wrong.result.slopes[0].factor = 0.3;  // weights no longer sum to 1
    EXPECT_EQ(bench::order_of(wrong), 0);
}

// Recipe "a linearly implicit method": a table of stages, each with one linear system.

/// The linearly implicit Euler method: (I - h J) u = h f, y⁺ = y + u.
bench::LinearPlan implicit_euler() { return {"w-euler", "linearly implicit Euler", "textbook", 1, {{1.0, {}, {}}}, {{0, 1.0}}}; }

TEST(LinearMethodRecipe, ItsTimesAreDerivedAndConsistent) {
    const bench::LinearTimes times = bench::times_of(implicit_euler());
    ASSERT_EQ(times.stage.size(), 1u);
    EXPECT_EQ(times.stage[0], 0.0);
    EXPECT_DOUBLE_EQ(times.result, 1.0);
}

/// The row above means (1 - γz) u = γz y, y⁺ = y + m u on y' = λy with z = hλ, by the header's formula.
TEST(LinearMethodRecipe, DampsWhatIsStiffAsTheoryTells) {
    const bench::LinearPlan plan = implicit_euler();
    const double gamma = plan.stages[0].gamma, weight = plan.result[0].factor;
    for (const double z : {-0.1, -1.0, -1e6}) {
        const double growth = 1.0 + weight * gamma * z / (1.0 - gamma * z);
        EXPECT_NEAR(growth, 1.0 / (1.0 - z), 1e-10) << z;  // cancellation of 1 + z/(1 - z): some ulps of 1
    }
}

TEST(LinearMethodRecipe, TheCatalogueHasARowForEveryPlan) {
    for (const bench::LinearPlan& plan : bench::linear_plans()) EXPECT_NE(tasks::find_program(plan.name), nullptr) << plan.name;
}

// Recipe "a friction law": a struct with the functions of model/law/friction_laws.hpp. As the only law of a list it goes through
// everything that kernels, the slip solver and the exact Jacobian call; in the program, it would be one more name in FrictionLaws.

/// s = u/(1 + u): rises without a corner and is never quite full.
struct RationalLaw {
    static constexpr model::FrictionLaw law = model::FrictionLaw::piecewise;  // a new enumerator, were it in the program

    static double proportional(double) noexcept { return 0.0; }
    static double full(double) noexcept { return std::numeric_limits<double>::infinity(); }
    static double shape(double, double) noexcept { return 0.0; }

    template <int W>
    static Lanes<W> divisor(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
        return curve.saturation_speed + speed;
    }
    template <int W>
    static Lanes<W> secant(const FrictionCurve&, const Lanes<W>&, const Lanes<W>& inverse) noexcept {
        return inverse;
    }
    template <int W>
    static Lanes<W> tangent(const FrictionCurve& curve, const Lanes<W>& speed) noexcept {
        const Lanes<W> inverse = 1.0 / divisor<W>(curve, speed);
        return curve.saturation_speed * (inverse * inverse);
    }
    template <int W>
    static Lanes<W> share(const FrictionCurve& curve, const Lanes<W>& velocity) noexcept {
        return velocity * (1.0 / divisor<W>(curve, abs(velocity)));
    }
};

/// Curve that FrictionCurve's constructor makes for a law in the program's list.
FrictionCurve rational(double v0) {
    FrictionCurve curve({0.09, v0}, {});
    curve.proportional_speed = 1e-30 * v0;
    curve.full_speed = RationalLaw::full(0.0);
    curve.linear_speed_squared = 0.0;
    return curve;
}

TEST(LawRecipe, TheToyOwesWhatAllLawsOwe) {
    model::expect_a_law<model::LawList<RationalLaw>>(rational(0.01));
    model::expect_the_derivative_of_the_law<model::LawList<RationalLaw>>(rational(0.01));
}

TEST(LawRecipe, TheToyIsTheOneThatWasMeant) {
    for (const double u : model::law_speeds)
        EXPECT_NEAR((model::share_at<model::LawList<RationalLaw>>(rational(0.01), 0.01 * u)), u / (1.0 + u), 1e-15) << u;
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

struct Times final : engine::Controller {
    int left;
    explicit Times(int times) : left(times) {}
    int next() noexcept override { return left-- > 0 ? 0 : stop; }
};

TEST(ExecutorRecipe, RunsEveryTaskOncePerCycleAndInOrder) {
    engine::TaskGraph graph;
    const auto note = [](void* context, int item) noexcept { static_cast<std::vector<int>*>(context)->push_back(item); };
    const int first = graph.add({"first", 0, note, 0, {}}), left = graph.add({"left", 0, note, 1, {}}),
              right = graph.add({"right", 0, note, 2, {}});
    const int last = graph.add({"last", 0, note, 3, {}});
    for (const int middle : {left, right}) {
        graph.order(first, middle);
        graph.order(middle, last);
    }
    graph.freeze();
    std::vector<int> seen;
    seen.reserve(8);  // bodies are noexcept
    Times twice(2);
    Backward().run(graph, &seen, twice);
    EXPECT_EQ(seen, (std::vector<int>{0, 2, 1, 3, 0, 2, 1, 3}));
}

TEST(ExecutorRecipe, RefusesAGraphThatIsNotFrozen) {
    engine::TaskGraph graph;
    Times once(1);
    EXPECT_THROW(Backward().run(graph, nullptr, once), std::logic_error);
}

// Recipe "a channel": one row of tasks/channel/channels.cpp.

/// Sum of the tensions of both strands.
double sum_of_strands(const tasks::Instant& now) { return now.observation.tight + now.observation.slack; }
const tasks::Channel strand_sum{"strands/sum", "N", "tension of both strands together", sum_of_strands};

TEST(ChannelRecipe, ReadsWhatItSaysAndWritesItsWidth) {
    claims::Rig rig(tasks::tiny_parameters());
    model::Observer observer(rig.variator());
    const model::Observation& observation = observer.observe(rig.time(), rig.state(), rig.phases().data());
    double values[]{0.0, -1.0};
    strand_sum.read({observation, rig.workspace(), rig.counters(), 0, observer}, values);
    EXPECT_EQ(strand_sum.width(rig.variator().chain()), 1);
    EXPECT_EQ(values[0], observation.tight + observation.slack);
    EXPECT_EQ(values[1], -1.0);
}

// Recipe "a key of scenes": a member and a row of the parameter table, from which reading, units, limits and documents follow.

/// The member represents a new one of the parameters.
const tasks::Parameter toy_length{
    "half.toy_length", "m", 1e-3, 0.1, {}, tasks::of<&model::Half::length>, "Length of nothing, for a recipe.", "recipe"};

std::vector<tasks::Problem> read_toy(const tasks::Node& node, tasks::Scene& scene) {
    std::vector<tasks::Problem> problems;
    tasks::read_value(toy_length, node, scene, problems);
    return problems;
}

TEST(KeyRecipe, ItsRowReadsNumbersAndTextsWithUnits) {
    tasks::Scene scene;
    EXPECT_TRUE(read_toy({0.02, {}}, scene).empty());
    EXPECT_EQ(scene.parameters.half.length, 0.02);
    EXPECT_TRUE(read_toy({std::string("30 mm"), {}}, scene).empty());
    EXPECT_DOUBLE_EQ(scene.parameters.half.length, 0.03);
}

TEST(KeyRecipe, ItsRowRefusesWrongDimensionsAndValuesOutsideItsRange) {
    tasks::Scene scene;
    const double before = scene.parameters.half.length;
    EXPECT_EQ(read_toy({std::string("3 kg"), {}}, scene).size(), 1u);
    EXPECT_EQ(read_toy({0.5, {}}, scene).size(), 1u);
    EXPECT_EQ(scene.parameters.half.length, before);
}

TEST(KeyRecipe, ItsRowKnowsItsSectionAndKind) {
    EXPECT_EQ(toy_length.section(), "half");
    EXPECT_EQ(toy_length.name(), "toy_length");
    EXPECT_EQ(toy_length.kind(), tasks::Kind::number);
}

// The files that recipes name exist, and each recipe has its worked example.

TEST(Recipes, NameFilesThatAreThere) {
    static const std::regex step("[0-9]+\\. `([^`]+)`.*"), example("Worked example: \\[`[^`]+`\\]\\(([^)]+)\\).*"), heading("### Add (.*)");
    std::ifstream file(fs::path(CVTFLOW_SOURCE_DIR) / "CONTRIBUTING.md");
    int recipes = 0, steps = 0, examples = 0;
    for (std::string line; std::getline(file, line);) {
        std::smatch match;
        if (std::regex_match(line, match, heading)) ++recipes;
        const bool names_file = std::regex_match(line, match, step), names_example = !names_file && std::regex_match(line, match, example);
        if (recipes == 0 || (!names_file && !names_example)) continue;
        ++(names_file ? steps : examples);
        EXPECT_TRUE(fs::exists(fs::path(CVTFLOW_SOURCE_DIR) / match[1].str())) << line;
    }
    EXPECT_EQ(recipes, 7);
    EXPECT_EQ(examples, recipes);
    EXPECT_GE(steps, 2 * recipes);
}

}  // namespace
}  // namespace cvtflow::recipes
