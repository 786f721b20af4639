#include "tasks/run/run_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

#include "engine/base/hash.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tasks/run/saved_start.hpp"

namespace cvtflow::tasks {

namespace {

/// Rows of channels per write. Writing all datasets once costs as much as hundreds of rows. The buffer is limited to a few megabytes, and
/// to the rows of the run, because a chunk takes its full size in the file. @param rows of the whole run
int rows_together(const std::vector<engine::ChannelInfo>& channels, double rows) {
    constexpr std::size_t least = 16, fewest = 512, most = 2048, numbers = std::size_t{1} << 21U;
    std::size_t width = 1;  // of the time
    for (const engine::ChannelInfo& channel : channels) width += static_cast<std::size_t>(channel.width);
    const std::size_t together = std::clamp(numbers / width, fewest, most);
    return static_cast<int>(rows < static_cast<double>(together) ? std::max(least, static_cast<std::size_t>(rows)) : together);
}

/// Outputs or states of a run, the one at its begin included. interval [s]
double instants(const Scene& scene, double interval) { return std::floor(latest_end(scene) / interval * (1.0 + 1e-12)) + 1.0; }

std::vector<const Channel*> recorded_channels(const Scene& scene) {
    std::vector<std::string> names = scene.run.channels;
    if (scene.cycle.present()) names.emplace_back("vehicle/*");
    return chosen_channels(names, scene.parameters);
}

engine::TableInfo transition_table() {
    return {"transitions",
            "changes of phase of tips: 0 free, 1 touching, 2 stick, 3 slip",
            {{"time", "s", "when"},
             {"pin", "1", "whose tip", engine::ColumnType::integer},
             {"tip", "1", "4 link + 2 (front half) + (side +z)", engine::ColumnType::integer},
             {"from", "1", "phase before", engine::ColumnType::integer},
             {"to", "1", "phase after", engine::ColumnType::integer}}};
}

/// 128 random bits: two runs of the same scene differ in nothing else.
std::string new_identity() {
    std::random_device draw;
    return fmt::format("{:08x}{:08x}{:08x}{:08x}", draw(), draw(), draw(), draw());
}

std::vector<engine::Attribute> attributes_of_run(const Scene& scene, const std::string& run) {
    std::vector<engine::Attribute> attributes = engine::attributes_of(engine::current_provenance());
    attributes.push_back({"run", run});
    attributes.push_back({"scene", scene.name});
    attributes.push_back({"scene_text", scene.text});
    if (!scene.path.empty()) attributes.push_back({"scene_path", std::filesystem::absolute(scene.path).string()});
    attributes.push_back({"parameters", write_scene(scene)});
    attributes.push_back({"method", method_of(scene)});
    attributes.push_back({"step", scene.run.step});
    attributes.push_back({"seed", static_cast<std::int64_t>(scene.run.seed)});
    return attributes;
}

engine::RunContents contents_of(const Scene& scene, const model::ChainModel& chain, const std::vector<const Channel*>& channels,
                                const std::string& run) {
    const model::ChainLayout& at = chain.layout();
    engine::RunContents contents;
    for (const Channel* channel : channels) {
        contents.channels.push_back({std::string(channel->name), std::string(channel->unit), std::string(channel->description),
                                     channel->width(chain), std::string(channel->axis)});
    }
    contents.state_size = static_cast<std::size_t>(at.size());
    contents.phase_count = static_cast<std::size_t>(model::tips_per_link * at.links);
    contents.state_description = fmt::format(
        "{} links of [q | v], {} coordinates each (a.x, b.x, a.y, b.y, a.z, a.e, b.z, b.e; orders 0...{}), then pulleys [q | v], {} "
        "coordinates",
        at.links, at.link_size(), at.lateral() - 1, at.pulley_size);
    contents.tables = {transition_table()};
    contents.attributes = attributes_of_run(scene, run);
    return contents;
}

}  // namespace

double record_bytes(const Scene& scene, const model::ChainModel& chain) {
    double row = sizeof(double);  // its time
    for (const Channel* channel : recorded_channels(scene)) {
        const int width = channel->width(chain);
        row += width > 1 ? sizeof(float) * width : sizeof(double);
    }
    const double state = sizeof(double) * (1.0 + chain.layout().size()) + model::tips_per_link * chain.layout().links;
    return instants(scene, scene.run.output_interval) * row +
           instants(scene, std::max(scene.run.state_interval, scene.run.output_interval)) * state;
}

void RowSamples::between(double time, double next, std::span<const double> row, std::span<double> out) const {
    const double share = (time - last_) / (next - last_);
    for (std::size_t k = 0; k < row.size(); ++k) out[k] = (1.0 - share) * before_[k] + share * row[k];  // row where share is 1
}

void RowSamples::add(double time, std::span<const double> row) {
    const double half = any_ ? 0.5 * (time - last_) : 0.0;
    for (std::size_t k = 0; means_ && k < row.size(); ++k) sum_[k] += half * (before_[k] + row[k]);
    std::copy_n(row.data(), row.size(), before_.data());
    if (!any_) begin_ = time;
    last_ = time, any_ = true;
}

void RowSamples::take(std::span<double> row) {
    if (!means_) return;
    const double span = last_ - begin_;
    for (std::size_t k = 0; k < row.size(); ++k) {
        if (averaged_[k] && span > 0.0) row[k] = sum_[k] / span;
        sum_[k] = 0.0;
    }
    begin_ = last_;
}

void RowSamples::visit(engine::Archive& archive) {
    archive("row_begin", begin_), archive("row_sampled", last_), archive("row_any", any_);
    archive("row_before", std::span(before_)), archive("row_sum", std::span(sum_));
}

RunRecorder::RunRecorder(const Scene& scene, const Simulation& simulation, const RunOptions& options)
    : options_(options),
      state_interval_(scene.run.state_interval),
      followed_pin_(scene.run.followed_pin),
      has_pulleys_(simulation.workspace().layout().pulley_size != 0),
      observer_(simulation.workspace().variator),
      channels_(recorded_channels(scene)),
      between_(simulation.part().outputs_together() > 1),
      output_interval_(scene.run.output_interval),
      longest_step_(between_ ? simulation.part().step_choice()->longest() : 0.0) {
    std::vector<bool> averaged;
    for (const Channel* channel : channels_)
        averaged.insert(averaged.end(), static_cast<std::size_t>(channel->width(simulation.workspace().variator.chain())),
                        !channel->is(Channel::unaveraged));
    row_.resize(averaged.size());
    row_between_.resize(averaged.size());
    samples_ = RowSamples(std::move(averaged), scene.run.means);
    means_.seek_steady(steady_rule(scene));
    if (!options.file.empty()) {
        run_ = options.from != nullptr && !options.from->run.empty() ? options.from->run : new_identity();
        contents_ = contents_of(scene, simulation.workspace().variator.chain(), channels_, run_);
        engine::OutputFile file = options.file;
        if (options.from != nullptr)
            former_ =
                engine::former_record(file, [run = run_](const std::string& there) { return engine::is_record_with(there, "run", run); });
        file_ = std::make_unique<engine::RunFile>(
            file, contents_,
            engine::RunFileOptions{.channel_rows = rows_together(contents_.channels, instants(scene, scene.run.output_interval)),
                                   .continues = options.from != nullptr});
    }
}

void RunRecorder::begin_part(double begin, double until) noexcept {
    begin_ = begin;
    until_ = until;
}

void RunRecorder::output(double time, const Workspace& workspace, const Counters& counters) {
    if (options_.progress) {
        const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
        options_.progress({begin_, time, until_, wall, counters});
    }
    if (begin_ < 0.0) return;  // settling is not recorded
    const model::Observation& now = workspace.observed_by(observer_, time);
    ++outputs_;
    add_sample(means_, now, workspace, time);
    if (!file_) return;
    read({now, workspace, counters, followed_pin_, observer_});
    if (between_ && samples_.any()) {
        add_between(time, workspace);
        if (time != workspace.step.output) return;  // a call ends here
    } else {
        samples_.add(time, row_);
        write(time, row_);
        next_output_ = time + output_interval_;
    }
    write_state(time, workspace);
}

bool RunRecorder::near_output(double time) const noexcept {
    return time > next_output_ || next_output_ - time < longest_step_ * (1.0 + 1e-9);
}

void RunRecorder::add_between(double time, const Workspace& workspace) {
    constexpr double close = 1e-6;  // an output this near the end of a step is there [intervals]
    const double exact = workspace.step.output, from = (samples_.last() - exact) / output_interval_;
    double number = std::floor(from + close) + 1.0;
    for (; samples_.any() && number <= (time - exact) / output_interval_ + close; ++number) {
        const double due = exact + number * output_interval_;
        samples_.between(due, time, row_, row_between_);
        samples_.add(due, row_between_);
        write(due, row_between_);
    }
    next_output_ = exact + number * output_interval_;
    samples_.add(time, row_);
}

void RunRecorder::read(const Instant& instant) {
    double* next = row_.data();
    for (const Channel* channel : channels_) {
        channel->read(instant, next);
        next += channel->width(instant.workspace.variator.chain());
    }
}

void RunRecorder::write(double time, std::span<double> row) {
    samples_.take(row);
    file_->append(time, row);
    written_.channels.add(time, row);
}

void RunRecorder::write_state(double time, const Workspace& workspace) {
    if (time < next_state_ - 1e-9 * state_interval_) return;
    while (next_state_ <= time + 1e-9 * state_interval_) next_state_ += state_interval_;
    const auto* phases = reinterpret_cast<const std::uint8_t*>(workspace.tips.phases.data());
    const std::span<const double> state(workspace.state(), static_cast<std::size_t>(workspace.layout().size()));
    file_->append_state(time, state, {phases, workspace.tips.phases.size()});
    written_.states.add(time, state, {phases, workspace.tips.phases.size()});
}

void RunRecorder::transition(const TransitionRecord& record) {
    if (begin_ < 0.0 || !file_) return;
    const double values[] = {record.time, static_cast<double>(record.pin), static_cast<double>(record.tip),
                             static_cast<double>(record.from), static_cast<double>(record.to)};
    file_->append_row("transitions", values);
    written_.tables[0].add(0.0, values);
}

void RunRecorder::sample(double time, const Workspace& workspace, const Counters& counters) {
    const model::Observation& now = workspace.observed_by(observer_, time);
    if (means_.curve().due(time)) add_sample(means_, now, workspace, time);
    const bool again = samples_.any() && time <= samples_.last();  // by a run that continues here
    if (!file_ || again || !(between_ ? near_output(time) : samples_.means())) return;
    read({now, workspace, counters, followed_pin_, observer_});
    between_ ? add_between(time, workspace) : samples_.add(time, row_);
}

void RunRecorder::visit(engine::Archive& archive) {
    for (engine::RowsWritten* rows : {&written_.channels, &written_.states, &written_.tables[0]})
        archive("rows", rows->count), archive("rows_sum", rows->sum);
    archive("next_state", next_state_), archive("rows_of_outputs", outputs_);
    if (samples_.means() || between_) samples_.visit(archive), archive("next_output", next_output_);
    means_.visit(archive);
}

std::vector<std::byte> RunRecorder::position() {
    if (file_) file_->flush();
    std::vector<std::byte> fields;
    engine::write_fields(fields, [this](auto& archive) { visit(archive); });
    return fields;
}

void RunRecorder::restore(std::span<const std::byte> position) {
    engine::read_fields(position, [this](auto& archive) { visit(archive); });
    if (!file_) return;
    if (former_.path.empty() && written_.channels.count > 0)
        throw engine::RecordError(options_.file.path + ": the checkpoint's record does not exist");
    if (former_.path.empty()) return file_->take_place();
    engine::copy_record(former_.path, written_, contents_, *file_);
    former_ = {};
}

void RunRecorder::finish(const Simulation& simulation, RunReport& report, double wall) {
    report.wall = wall > 0.0 ? wall : std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
    report.end = simulation.time();
    report.step = simulation.step();
    report.energy = simulation.workspace().energy.balance(means_.mark());
    report.balance_error_ratio = simulation.balance_error_ratio(means_.mark());
    report.judged = simulation.workspace().energy.judged(means_.mark());
    report.hash = simulation.hash();
    report.outputs = outputs_;
    report.has_pulleys = has_pulleys_;
    report.whole = means_.all();
    report.first_fifth = means_.fifth(0);
    report.last_fifth = means_.fifth(4);
    report.cycle_miss = means_.cycle_miss();
    report.errors = means_.errors();
    report.revolutions = static_cast<double>(means_.steady().begin) / std::max(1.0, means_.rule().pins);
    report.notes = notes(means_, report.energy, report.has_pulleys);
    if (!file_) return;
    file_->set_attribute({std::string(step_taken_attribute), report.step});
    if (report.fault)
        file_->set_status(report.fault.message());
    else if (!report.reliable())
        file_->set_status(unreliable_text(report));
    else if (report.whole.cycle_missed())
        file_->set_status("cycle_missed: " + report.cycle_miss.text(report.whole));
    file_->set_attribute({"energy_residual", report.energy.residual()});
    file_->set_attribute({"energy_residual_relative", report.energy.relative()});
    file_->set_attribute({"energy_error_ratio", report.balance_error_ratio});
    std::string notes, texts;
    for (const Note& note : report.notes) {
        notes += (notes.empty() ? "" : "; ") + std::string(note.name);
        texts += fmt::format("{}: {}\n", note.name, note.text);
    }
    std::string errors;
    for (std::size_t k = 0; k < MeanErrors::count && report.errors.batches > 0; ++k)
        errors += fmt::format("{}: {:.3g}\n", MeanErrors::name(k), report.errors.error[k].sum());
    file_->set_attribute({"errors_of_means", errors});
    file_->set_attribute({"notes", notes});
    file_->set_attribute({"note_texts", texts});
    file_->set_attribute({"means", report.whole.text() + "\n" + report.last_fifth.text()});
    file_->set_attribute({"state_hash", engine::hex(report.hash)});
    file_->set_attribute({"wall_seconds", report.wall});
    file_->close();
}

}  // namespace cvtflow::tasks
