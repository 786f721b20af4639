#include "tasks/tuning/verified_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/hash.hpp"
#include "engine/base/text.hpp"
#include "engine/record/case_table.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/batch/results/sweep_files.hpp"
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

/// The table once more, with errors in rows and the hash of these rows.
void write_errors(const std::string& file, const Sweep& sweep, const TunedSweep& tuned, const ErrorsByCase& errors) {
    OrderedRows rows(file);
    engine::CaseTable head = rows.head();
    const engine::RowLayout& layout = head.layout;
    const auto add_errors = [&](std::span<std::byte> row) {
        const auto found = errors.find(layout.integer(row, layout.column("case")));
        if (found == errors.end()) return;
        for (std::size_t i = 0; i < sweep.scalars.size(); ++i)
            layout.put(row, layout.column(std::string(error_prefix) + sweep.scalars[i].column), found->second[i]);
        layout.seal(row);
    };
    head.set({target_attribute, number_text(sweep.accuracy.target)});
    head.set({"accuracy_choice", tuned.kept.choice.text()});
    head.set({"accuracy_at_corners", number_text(tuned.kept.error)});
    head.set({"results_hash", rows.hash(add_errors)});
    engine::write_cases(permit_table(file, head.attribute("definition")), head, rows.size(),
                        [&](std::size_t first, std::span<std::byte> some) {
                            rows.fill(first, some);
                            for (std::size_t at = 0; at < some.size(); at += layout.bytes()) add_errors(some.subspan(at, layout.bytes()));
                        });
}

}  // namespace

std::vector<std::string> verify_sweep(const Sweep& sweep, const TunedSweep& tuned, const std::string& folder,
                                      const engine::Cancellation& cancel, const std::function<void(const std::string&)>& progress) {
    const std::string file = (fs::path(folder) / "cases.h5").string();
    const engine::FolderLock lock(folder);
    DialSweep dial(points_of(sweep, cases_to_verify(sweep)), cancel);
    ErrorsByCase errors;
    std::vector<std::string> remarks;
    {
        OrderedRows rows(file);
        const engine::RowLayout layout = rows.head().layout;
        for (std::size_t i = 0; i < dial.size(); ++i) {
            const auto row = rows.of_case(dial.points().cases[i]);
            if (row.empty() || layout.text(row, layout.column("status")) != "ok") continue;
            if (std::isfinite(layout.real(row, layout.column(std::string(error_prefix) + sweep.scalars.front().column)))) continue;
            if (progress) progress("verifying " + dial.points().names[i]);
            const DialSweep::Reference& reference = dial.reference(i, reference_share * sweep.accuracy.target);
            PointRun is;
            for (const Scalar& scalar : sweep.scalars) is.values.push_back(layout.real(row, layout.column(scalar.column)));
            if (reference.run != nullptr)
                errors[dial.points().cases[i]] = dial.errors(is, *reference.run);
            else
                remarks.push_back(fmt::format("{}: {}", dial.points().names[i], reference.text));
        }
    }
    write_errors(file, sweep, tuned, errors);
    return remarks;
}

SweepVerification sweep_verification(const std::string& file) {
    OrderedRows rows(file);
    const engine::CaseTable& head = rows.head();
    SweepVerification verification;
    verification.target = engine::number_of(head.attribute(target_attribute)).value_or(0.0);
    std::vector<std::size_t> columns;
    for (const engine::TableColumn& column : head.layout.columns()) {
        if (!column.name.starts_with(error_prefix)) continue;
        columns.push_back(head.layout.column(column.name));
        verification.scalars.push_back(column.name.substr(error_prefix.size()));
    }
    verification.worst.resize(columns.size(), 0.0);
    std::vector<std::byte> row(head.layout.bytes());
    for (std::size_t at = 0; at < rows.size() && !columns.empty(); ++at) {
        rows.fill(at, row);
        double worst = 0.0;
        if (std::isnan(head.layout.real(row, columns.front()))) continue;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const double error = head.layout.real(row, columns[i]);
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
