#include "tasks/tuning/tuned_scene.hpp"

#include <fmt/format.h>

#include <map>
#include <sstream>

#include "engine/base/hash.hpp"
#include "engine/base/input_file.hpp"
#include "engine/base/provenance.hpp"
#include "engine/base/text.hpp"
#include "engine/record/run/output_rule.hpp"
#include "engine/record/run/schema.hpp"
#include "model/kernels/available_isas.hpp"
#include "tasks/run/saved_start.hpp"

namespace cvtflow::tasks {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kept_format = "cvtflow tuning 3";

std::string content_of(const std::string& key, const KeptTuning& kept) {
    return fmt::format("{}\nkey {}\ndetail {}\nmethod {}\nshare {:.17g}\nstep {:.17g}\nerror {:.17g}\n", kept_format, key,
                       kept.choice.detail, kept.choice.method, kept.choice.share, kept.step, kept.error);
}

std::string sealed(const std::string& content) { return content + "seal " + engine::Hash().add(std::string_view(content)).hex() + "\n"; }

fs::path text_file(const fs::path& folder, const std::string& key) { return folder / (key + ".tuning"); }

fs::path state_file(const fs::path& folder, const std::string& key) { return fs::absolute(folder / (key + ".h5")).lexically_normal(); }

/// Whether a kept state is whole and has the unknowns of a scene.
bool is_start_of(const fs::path& file, const Scene& scene) {
    try {
        return engine::read_state(file.string()).state.size() ==
               static_cast<std::size_t>(model::layout_of(scene.parameters).ledger_begin());
    } catch (const engine::RecordError&) {
        return false;
    }
}

/// Keeps a state. @return whether its place can be written to
bool keep_state(const fs::path& file, const engine::SavedState& state) {
    try {
        engine::write_state(file.string(), state);
        return true;
    } catch (const engine::RecordError&) {
        return false;
    }
}

}  // namespace

const TunedChoice& chosen_of(const TuneResult& result) {
    if (result.chosen) return result.choices[*result.chosen];
    const TunedChoice* best = nullptr;
    for (const TunedChoice& choice : result.choices) {
        if (choice.tried && (best == nullptr || choice.error() < best->error())) best = &choice;
    }
    if (!result.used_up_by.empty()) throw AccuracyError(fmt::format("{}: {}", result.scene, result.why_none()), true);
    throw AccuracyError(fmt::format("{}: no tried choice is within {:g} % (with a margin of {:g}){}", result.scene, 100.0 * result.accuracy,
                                    result.margin,
                                    best == nullptr ? "" : fmt::format("; nearest: {}: {}", best->choice.text(), best->outcome)));
}

fs::path usual_tuning_folder() {
    const char *chosen = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    if (chosen != nullptr && fs::path(chosen).is_absolute()) return fs::path(chosen) / "cvtflow";
    return home != nullptr && *home != '\0' ? fs::path(home) / ".cache" / "cvtflow" : fs::path();
}

std::string tuning_key(const Scene& scene, const TuneSettings& settings) {
    const engine::Provenance here = engine::current_provenance();
    Scene placeless = scene;  // the content of its state counts, not where it lies
    placeless.state_file.clear();
    engine::Hash hash;
    for (const std::string& text : {write_scene(placeless), here.version, here.commit, std::string(model::name_of(model::chosen_isa()))})
        hash.add(std::string_view(text)).add(std::string_view("\n"));
    if (!scene.state_file.empty()) {
        const auto saved = saved_start(scene);
        hash.add(std::span<const double>(saved->state)).add(std::span<const std::uint8_t>(saved->phases));
    }
    for (const std::string& output : settings.outputs) hash.add(std::string_view(output)).add(std::string_view("\n"));
    for (const std::string& method : settings.methods) hash.add(std::string_view(method)).add(std::string_view("\t"));
    // without the budget: a choice that was found within one does not depend on it
    const double numbers[] = {settings.accuracy, settings.same_everywhere ? 1.0 : 0.0, settings.times.settle, settings.times.average};
    return hash.add(std::span<const double>(numbers)).hex();
}

std::optional<KeptTuning> read_tuning(const fs::path& folder, const std::string& key) {
    constexpr std::uint64_t longest = 65536;
    std::string text;
    try {
        text = engine::read_text_input(text_file(folder, key).string(), longest);
    } catch (const engine::InputError&) {
        return std::nullopt;  // none, or what cannot be one
    }
    std::map<std::string, std::string> values;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) values[line.substr(0, line.find(' '))] = line.substr(line.find(' ') + 1);
    const auto number = [&](const char* name) { return engine::number_of(values[name]).value_or(0.0); };
    KeptTuning kept{{values["detail"], values["method"], number("share")}, number("step"), number("error")};
    if (kept.choice.share == 1.0) kept.choice.step = kept.step;
    if (text != sealed(content_of(key, kept))) return std::nullopt;
    return kept;
}

void keep_tuning(const fs::path& folder, const std::string& key, const KeptTuning& kept) {
    std::error_code unwritable;
    fs::create_directories(folder, unwritable);
    try {
        const engine::OutputRule rule{.what = "kept tuning", .own = engine::text_with({"cvtflow tuning"})};
        engine::write_whole({text_file(folder, key).string(), rule}, sealed(content_of(key, kept)));
    } catch (const engine::RecordError&) {
        // Nothing is kept: the folder cannot be written, something else has the name, or another run is keeping the same.
    }
}

KeptTuning kept_or_found(const fs::path& folder, const std::string& key, const std::function<TuneResult()>& search,
                         std::optional<TuneResult>& result) {
    if (const auto kept = read_tuning(folder, key)) return *kept;
    result = search();
    const TunedChoice& chosen = chosen_of(*result);
    keep_tuning(folder, key, {chosen.choice, chosen.step, chosen.error()});
    return {chosen.choice, chosen.step, chosen.error()};
}

TunedScene tuned_scene(const Scene& scene, const TuneSettings& settings, const fs::path& folder, const engine::Cancellation& cancel) {
    const std::string key = tuning_key(scene, settings);
    Tuner tuner(scene, settings, cancel);
    TunedScene tuned;
    tuned.kept = kept_or_found(
        folder, key, [&] { return tuner.tune(settings.accuracy); }, tuned.result);
    tuned.scene = chosen_scene(scene, tuned.kept.choice, tuned.kept.step);
    if (model::layout_of(scene.parameters) == model::layout_of(tuned.scene.parameters)) return tuned;
    tuned.scene.state_file.clear();  // it has other unknowns
    if (fitting_start(scene) == nullptr) return tuned;
    const fs::path state = state_file(folder, key);
    const bool known = !tuned.result && is_start_of(state, tuned.scene);
    if (known || keep_state(state, tuner.settled_state(tuned.kept.choice, tuned.kept.step))) tuned.scene.state_file = state.string();
    return tuned;
}

bool needs_own_state(const Scene& scene, const Scene& chosen) {
    if (scene.parameters.start.layout != model::StartLayout::belt) return false;
    return scene.state_file.empty() || model::layout_of(scene.parameters) != model::layout_of(chosen.parameters);
}

std::string tuned_text(const Scene& scene, const TuneResult& result, const std::string& state) {
    const TunedChoice& chosen = chosen_of(result);
    const engine::Provenance here = engine::current_provenance();
    std::string text = fmt::format("# {} for an accuracy of {:g} %: {}.\n# Made by cvtflow {} ({}) on {}.\n#\n", result.scene,
                                   100.0 * result.accuracy, chosen.choice.text(), here.version, here.commit, here.cpu);
    text += fmt::format("# Largest errors at the operating points below; {:g} times them are within the target:\n", result.margin);
    for (std::size_t i = 0; i < result.outputs.size(); ++i)
        text += fmt::format("#   {:<20} {:.2g} %\n", result.outputs[i], 100.0 * chosen.errors[i]);
    text += fmt::format("# {:.3g} s of processor time per simulated second. Measured against:\n", chosen.seconds);
    for (std::size_t i = 0; i < result.points.size(); ++i) text += fmt::format("#   {}: {}\n", result.points[i], result.references[i]);
    for (const std::string& line : result.left_out) text += fmt::format("#   not checked: {}\n", line.substr(0, line.find('\n')));
    Scene file = chosen_scene(scene, chosen.choice, chosen.step);
    if (!state.empty()) file.state_file = state;
    return text + "\n" + write_scene(file);
}

}  // namespace cvtflow::tasks
