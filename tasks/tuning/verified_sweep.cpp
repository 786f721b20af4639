#include "tasks/tuning/verified_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/hash.hpp"
#include "engine/base/text.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/run/saved_start.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow::tasks {

namespace fs = std::filesystem;

namespace {

constexpr const char* target_attribute = "accuracy_target";

/// Writes the start state of the scene to the folder of the sweep, converted where the detail has other unknowns.
void give_state(const Scene& own, const std::string& file, Scene& chosen) {
    if (own.state_file.empty()) return;
    const auto saved = fitting_start(own);
    if (saved == nullptr) return chosen.state_file.clear();
    const model::Parameters settled = settled_parameters(*saved, own);
    if (model::layout_of(settled) == model::layout_of(chosen.parameters)) return;
    engine::SavedState state = convert_state(*saved, settled, chosen.parameters);
    fs::create_directories(fs::path(file).parent_path());
    engine::write_state(file, state);
    chosen.state_file = fs::absolute(file).string();
    chosen.start_state = KeptState();
}

}  // namespace

TunedSweep tuned_sweep(const Sweep& sweep, const std::string& folder, const engine::Cancellation& cancel,
                       const std::function<void(const std::string&)>& progress) {
    TunedSweep tuned{sweep, {}, std::nullopt};
    if (!(sweep.accuracy.target > 0.0)) return tuned;
    TuneSettings settings{.accuracy = sweep.accuracy.target, .same_everywhere = true, .progress = progress};
    const std::string key =
        engine::Hash().add(std::string_view(tuning_key(sweep.scene, settings))).add(std::string_view(sweep.definition())).hex();
    const auto search = [&] { return Tuner(sweep, settings, cancel).tune(settings.accuracy); };
    tuned.kept = kept_or_found(folder, key, search, tuned.result);
    tuned.sweep.scene = chosen_scene(sweep.scene, tuned.kept.choice, tuned.kept.step);
    if (sweep.start == StartMode::scene) give_state(sweep.scene, (fs::path(folder) / "states" / (key + ".h5")).string(), tuned.sweep.scene);
    return tuned;
}

std::vector<long> cases_to_verify(const Sweep& sweep) { return draw_cases(sweep.cases(), sweep.accuracy.verify, sweep.accuracy.seed); }

namespace {

using ErrorsByCase = std::map<long, std::vector<double>>;

/// The results once more, with errors in rows and the hash of these rows.
void write_errors(const std::string& folder, const Sweep& sweep, const TunedSweep& tuned, const ErrorsByCase& errors) {
    const SweepRows rows(folder);
    SweepFacts facts = rows.facts();
    facts.set({target_attribute, number_text(sweep.accuracy.target)});
    facts.set({"accuracy_choice", tuned.kept.choice.text()});
    facts.set({"accuracy_at_corners", number_text(tuned.kept.error)});
    const std::string text = rows.file([&](long number, std::vector<std::string>& cells) {
        const auto found = errors.find(number);
        for (std::size_t i = 0; found != errors.end() && i < sweep.scalars.size(); ++i)
            cells[rows.column(std::string(error_prefix) + sweep.scalars[i].column)] = number_text(found->second[i]);
    });
    write_results(folder, facts, text);
    facts.set({"results_hash", SweepRows(folder).hash()});
    write_facts(folder, facts);
}

}  // namespace

std::vector<std::string> verify_sweep(const Sweep& sweep, const TunedSweep& tuned, const std::string& folder,
                                      const engine::Cancellation& cancel, const std::function<void(const std::string&)>& progress) {
    DialSweep dial(points_of(sweep, cases_to_verify(sweep)), cancel);
    const SweepRows rows(folder);
    ErrorsByCase errors;
    std::vector<std::string> remarks;
    for (std::size_t i = 0; i < dial.size(); ++i) {
        const long number = dial.points().cases[i];
        if (!rows.files().has(number) || rows.text(number, "status") != "ok") continue;
        if (std::isfinite(rows.number(number, std::string(error_prefix) + sweep.scalars.front().column))) continue;
        if (progress) progress("verifying " + dial.points().names[i]);
        const DialSweep::Reference& reference = dial.reference(i, reference_share * sweep.accuracy.target);
        PointRun is;
        for (const Scalar& scalar : sweep.scalars) is.values.push_back(rows.number(number, scalar.column));
        if (reference.run != nullptr)
            errors[number] = dial.errors(is, *reference.run);
        else
            remarks.push_back(fmt::format("{}: {}", dial.points().names[i], reference.text));
    }
    write_errors(folder, sweep, tuned, errors);
    return remarks;
}

SweepVerification sweep_verification(const std::string& folder) {
    const SweepRows rows(folder);
    SweepVerification verification;
    verification.target = engine::number_of(rows.facts().text(target_attribute)).value_or(0.0);
    std::vector<std::string> columns;
    for (const ResultColumn& column : rows.facts().columns) {
        if (!column.name.starts_with(error_prefix)) continue;
        columns.push_back(column.name);
        verification.scalars.push_back(column.name.substr(error_prefix.size()));
    }
    verification.worst.resize(columns.size(), 0.0);
    if (columns.empty()) return verification;
    for (const long number : rows.files().numbers()) {
        if (std::isnan(rows.number(number, columns.front()))) continue;
        double worst = 0.0;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const double error = rows.number(number, columns[i]);
            verification.worst[i] = std::max(verification.worst[i], error);
            worst = std::max(worst, error);
        }
        ++verification.verified;
        verification.missed += !(worst <= verification.target);
    }
    return verification;
}

std::string SweepVerification::text() const {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < scalars.size(); ++i) parts.push_back(fmt::format("{} {:.2g} %", scalars[i], 100.0 * worst[i]));
    return fmt::format("{} case{} verified, {} beyond {:g} %{}", verified, verified == 1 ? "" : "s", missed, 100.0 * target,
                       verified > 0 ? fmt::format("; at most: {}", fmt::join(parts, ", ")) : "");
}

}  // namespace cvtflow::tasks
