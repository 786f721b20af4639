#include "tasks/batch/start_states.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/base/hash.hpp"
#include "engine/base/provenance.hpp"
#include "model/force/pulley_inputs.hpp"
#include "tasks/run/checkpoint.hpp"
#include "tasks/run/saved_start.hpp"

namespace cvtflow::tasks {

namespace {

constexpr std::size_t max_kept = 32;
constexpr std::string_view run_only[] = {"run.until",        "run.steady", "run.steady_limit", "run.state_interval",
                                         "run.followed_pin", "run.seed",   "run.max_steps",    "run.max_wall"};

/// Whether it belongs to the machine; the other sections describe how that is operated.
[[nodiscard]] bool describes_machine(const Parameter& key) {
    constexpr std::string_view machine[] = {"detail", "chain", "half", "plate", "joint", "tip", "pulley", "record"};
    return std::ranges::find(machine, key.section()) != std::end(machine);
}

/// Sections that do not affect the geometric start: inputs and settings of the run.
constexpr std::string_view operation[] = {"load", "clamping", "run"};

[[nodiscard]] std::uint64_t content(const Scene& scene) {
    engine::Hash hash;
    for (const Parameter& parameter : parameter_table()) {
        if (!matters_for_settling(parameter.key)) continue;
        hash.add(parameter.key).add(std::string_view(value_text(parameter, scene)));
    }
    return hash.value();
}

}  // namespace

bool matters_for_settling(std::string_view key) noexcept {
    return !may_change(key) && std::ranges::find(run_only, key) == std::end(run_only);
}

bool matters_for_placing(const Parameter& parameter) noexcept {
    return std::ranges::find(operation, parameter.section()) == std::end(operation);
}

StartStates::StartStates(const Sweep& sweep, std::filesystem::path folder) : sweep_(sweep), folder_(std::move(folder)) {
    shareable_ = sweep.start == StartMode::shared ||
                 (sweep.start == StartMode::settle &&
                  !std::all_of(sweep.axes.begin(), sweep.axes.end(), [this](const Axis& axis) { return matters(axis); }));
}

/// Whether cases in different rows of an axis settle differently.
bool StartStates::matters(const Axis& axis) const noexcept {
    const auto matters = [this](const Parameter* key) {
        if (sweep_.start != StartMode::shared) return matters_for_settling(key->key);
        return key->key == "run.method" || describes_machine(*key);
    };
    return std::any_of(axis.keys.begin(), axis.keys.end(), matters);
}

/// The first of all cases that are like this one in the axes that matter.
template <class Matters>
long StartStates::first_alike(long number, const Matters& matters) const noexcept {
    long first = 0;
    for (std::size_t axis = 0; axis < sweep_.axes.size(); ++axis) {
        first = first * static_cast<long>(sweep_.axes[axis].rows()) +
                (matters(sweep_.axes[axis]) ? static_cast<long>(sweep_.row(number, axis)) : 0);
    }
    return first;
}

std::string_view StartStates::kind(const Scene& scene) {
    if (sweep_.start == StartMode::scene) return file_state(scene) == nullptr ? "geometric" : "scene";
    return sweep_.start == StartMode::shared ? "shared" : "settled";
}

/// The value of a key in a map, or nothing.
template <class Map>
typename Map::mapped_type StartStates::kept(const Map& map, const typename Map::key_type& key) {
    return mutex_.guard([&] {
        const auto found = map.find(key);
        return found == map.end() ? typename Map::mapped_type() : found->second;
    });
}

template <class Map>
void StartStates::keep(Map& map, const typename Map::key_type& key, typename Map::mapped_type made) {
    mutex_.guard([&] {
        if (map.size() >= max_kept) map.erase(map.begin());
        map[key] = std::move(made);
    });
}

StartStates::State StartStates::of_case(long number, const Scene& scene, const engine::Cancellation& cancel) {
    if (sweep_.start == StartMode::scene) return file_state(scene);
    const long first = first_settling_alike(number);
    if (first < 0) return nullptr;
    if (State known = kept(of_settling_, first)) return known;
    State made = settled(settling_scene(number, scene), cancel);
    keep(of_settling_, first, made);
    return made;
}

long StartStates::first_settling_alike(long number) const noexcept {
    return shareable_ ? first_alike(number, [this](const Axis& axis) { return matters(axis); }) : -1;
}

/// Scene that is settled for a case: the case itself, or its machine operated as in the sweep's base scene.
Scene StartStates::settling_scene(long number, const Scene& scene) const {
    const bool shared = sweep_.start == StartMode::shared;
    Scene settling = shared ? sweep_.scene : scene;
    settling.state_file.clear();
    settling.run.schedule = "serial";
    settling.run.max_steps = 0;
    settling.run.max_wall = 0.0;
    settling.run.method = scene.run.method;
    for (std::size_t a = 0; shared && a < sweep_.axes.size(); ++a) {
        const Axis& axis = sweep_.axes[a];
        for (std::size_t k = 0; k < axis.keys.size(); ++k)
            if (describes_machine(*axis.keys[k])) apply(*axis.keys[k], axis.at(sweep_.row(number, a), k), settling);
    }
    return settling;
}

StartStates::Placed StartStates::placed(long number, const Scene& scene) {
    const auto matters = [](const Parameter* key) { return matters_for_placing(*key); };
    const long first = first_alike(number, [&](const Axis& axis) { return std::any_of(axis.keys.begin(), axis.keys.end(), matters); });
    if (Placed known = kept(placed_, first)) return known;
    auto made = std::make_shared<const model::StartState>(model::start_state(scene.parameters));
    keep(placed_, first, made);
    return made;
}

/// The state that the scene names, if there is one and it fits.
StartStates::State StartStates::file_state(const Scene& scene) {
    if (scene.state_file.empty()) return nullptr;
    State state = from_file(scene.state_file);
    if (start_fits(*state, scene)) return state;
    require_time_to_settle(scene, unfit_text(*state, scene));
    return nullptr;
}

StartStates::State StartStates::from_file(const std::string& path) {
    if (State state = kept(of_file_, path)) return state;
    auto state = std::make_shared<const engine::SavedState>(engine::read_state(path));
    keep(of_file_, path, state);
    return state;
}

/// A state that another process has settled. Its name promises a scene: what it contains is compared.
StartStates::State StartStates::shared_from_file(const std::string& path, std::uint64_t key) {
    State state = from_file(path);
    if (state->scene.empty() || content(parse_scene(state->scene, path, StartState::recorded)) != key)
        throw engine::RecordError(path + ": a shared start state of another scene than its name promises; remove it");
    if (state->program != engine::version_text())
        throw engine::RecordError(fmt::format("{}: a shared start state settled by cvtflow {}, this is {}; remove it", path, state->program,
                                              engine::version_text()));
    return state;
}

StartStates::State StartStates::settled(const Scene& scene, const engine::Cancellation& cancel) {
    const std::uint64_t key = content(scene);
    const std::string file = (folder_ / (engine::hex(key) + ".state")).string();
    if (State state = kept(of_file_, file)) return state;
    const bool mine = once_.claim(key);
    std::error_code missing;
    if (std::filesystem::exists(file, missing)) {
        if (mine) once_.made(key);
        return shared_from_file(file, key);
    }
    const std::unique_ptr<const std::uint64_t, std::function<void(const std::uint64_t*)>> announced(
        &key, [&](const std::uint64_t*) { once_.made(key); });
    Simulation simulation(scene, schedule_of(scene.run, scene.parameters.chain.pins));
    SilentObserver silent;
    if (simulation.needs_settling()) {
        if (const Fault fault = simulation.advance({.until = 0.0, .rows_between = true}, silent, cancel)) throw StartFault(fault);
    }
    const State state = std::make_shared<const engine::SavedState>(simulation.saved_state());
    std::filesystem::create_directories(folder_);
    try {
        engine::write_state(file, *state);
    } catch (const engine::RecordError&) {  // another session writes the same bits at this instant, or the next one settles again
    }
    keep(of_file_, file, state);
    return state;
}

void turn_shaft(double* state, const model::Parameters& parameters, int shaft, double angle) {
    const model::ChainLayout at = model::layout_of(parameters);
    double* coordinates = state + at.pulley_begin();
    if (at.pulley_size == 4) coordinates[shaft] += angle;
    if (at.pulley_size != 36) return;
    for (const int body : {shaft, model::sheave_body(shaft, 0), model::sheave_body(shaft, 1)})
        coordinates[model::body_freedom(body, model::PulleyCoordinates::turn)] += angle;
}

}  // namespace cvtflow::tasks
