#include "tasks/run/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "tasks/method/method.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::string_view changeable[] = {"scene.name",       "scene.description", "start.state",  "run.until",    "run.steady",
                                           "run.steady_limit", "run.max_steps",     "run.max_wall", "run.schedule", "run.assembly",
                                           "run.partition",    "run.segments",      "run.threads"};

std::string program_text() {
    const engine::Provenance here = engine::current_provenance();
    return fmt::format("cvtflow {}, {} {}, {}", engine::version_text(), here.compiler, here.build_type, here.instruction_set);
}

/// "cvtflow 0.2.0 (b9f2dddb)" of the above: builds for other processors compute the same.
std::string_view version_in(std::string_view program) { return program.substr(0, program.find(',')); }

void add_combination(const std::vector<engine::Term>& terms, engine::Hash& hash) {
    hash.add(static_cast<std::uint64_t>(terms.size()));
    for (const engine::Term& term : terms) hash.add(static_cast<std::uint64_t>(term.slot)).add(std::span<const double>(&term.factor, 1));
}

std::string hash_of_method(const Scene& scene) {
    const std::optional<Method> method = Method::find(method_of(scene));
    if (!method) return "none";
    const engine::StagePlan& plan = method->plan();
    engine::Hash hash;
    hash.add(std::string_view(plan.name));
    if (const MethodProgram* program = method->program()) hash.add(static_cast<std::uint64_t>(program->revision));
    for (const auto& stage : plan.stages) {
        add_combination(stage.states, hash);
        add_combination(stage.slopes, hash);
        hash.add(static_cast<std::uint64_t>(stage.keep + 1)).add(static_cast<std::uint64_t>(stage.slope + 1));
    }
    add_combination(plan.result.states, hash);
    add_combination(plan.result.slopes, hash);
    return hash.hex();
}

/// Hash of the slope without a sheave that is held: the scene alone decides.
std::string hash_of_slope(const IntegrationState& at, model::Variator variator) {
    model::HeldInputs held = variator.pulleys().torques().held();
    held.sheave.reset();
    variator.hold(held);
    model::EvaluationScratch scratch(variator.layout());
    std::vector<double> slope(static_cast<std::size_t>(variator.layout().size()));
    if (at.state.size() != slope.size()) return "another size";
    model::right_hand_side(variator, at.time, at.state.data(), at.phases.data(), slope.data(), scratch);
    return engine::hex(engine::state_hash(slope));
}

}  // namespace

void remove_checkpoint(const std::string& path) {
    std::error_code gone;
    for (const std::string& file : {path, path + ".part"}) {
        if (engine::is_state_file(file)) std::filesystem::remove(file, gone);
    }
}

void sign(Checkpoint& checkpoint, const Scene& scene, const model::Variator& variator) {
    static_cast<engine::StateHead&>(checkpoint) = head_of(scene, method_of(scene));
    checkpoint.path = scene.path.string();
    checkpoint.text = scene.text;
    checkpoint.program = program_text();
    checkpoint.method_hash = hash_of_method(scene);
    checkpoint.slope_hash = hash_of_slope(checkpoint.integration, variator);
}

Checkpoint read_checkpoint(const std::string& path) {
    Checkpoint checkpoint;
    engine::read_state_file(path, "checkpoint", [&](engine::Archive& archive) { checkpoint.visit(archive), archive.end(); });
    return checkpoint;
}

Scene scene_of(const Checkpoint& checkpoint) {
    Scene scene = parse_scene(checkpoint.scene, checkpoint.path, StartState::recorded);
    scene.text = checkpoint.text;
    return scene;
}

bool may_change(std::string_view key) noexcept {
    return std::find(std::begin(changeable), std::end(changeable), key) != std::end(changeable);
}

void require_same(const std::string& path, const Checkpoint& checkpoint, const Scene& scene, const model::Variator& variator, bool mixed) {
    const auto must_agree = [](const Parameter& key) { return !may_change(key.key); };
    std::vector<std::string> lines;
    for (const auto& [key, is, was] : differing_keys(scene, scene_of(checkpoint), must_agree))
        lines.push_back(fmt::format("  {} = {}, the checkpoint has {}", key->key, is, was));
    const auto written_by = [&] { return fmt::format("written by {}, this is {}", checkpoint.program, program_text()); };
    if (lines.empty() && checkpoint.method_hash != hash_of_method(scene)) {
        lines.push_back(fmt::format("  the method {} is another one, or has other coefficients; {}", method_of(scene), written_by()));
    }
    if (lines.empty() && checkpoint.slope_hash != hash_of_slope(checkpoint.integration, variator)) {
        lines.push_back(fmt::format("  the model computes other accelerations at the checkpoint's state; {}", written_by()));
    }
    if (lines.empty() && !mixed && version_in(checkpoint.program) != version_in(program_text()))
        throw SimulationError(fmt::format("{}: {}; --mixed resumes nevertheless", path, written_by()));
    if (!lines.empty()) throw SimulationError(fmt::format("{}: not a checkpoint of this scene:\n{}", path, fmt::join(lines, "\n")));
}

}  // namespace cvtflow::tasks
