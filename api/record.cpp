#include <cvtflow/record.hpp>

#include <algorithm>
#include <cmath>

#include "api/simulation_impl.hpp"
#include "engine/base/text.hpp"
#include "engine/record/run/run_reader.hpp"
#include "tasks/batch/results/results.hpp"
#include "tasks/channel/channels.hpp"
#include "tasks/run/run_recorder.hpp"

namespace cvtflow {
inline namespace v0 {

using api::entered;

namespace {

[[nodiscard]] RecordAttributes attributes_from(const std::vector<engine::Attribute>& rows) {
    RecordAttributes attributes;
    for (const engine::Attribute& row : rows) attributes.emplace_back(row.name, row.value);
    return attributes;
}

}  // namespace

struct Record::Impl {
    engine::RunReader reader;

    [[nodiscard]] engine::RecordedState recorded(std::size_t number) const {
        return entered(ErrorCode::record, [&] {
            const std::size_t count = reader.state_times().size();
            if (number >= count)
                throw Error(ErrorCode::argument, "state: number " + std::to_string(number) + " of " + std::to_string(count));
            return reader.state(number);
        });
    }
};

Record::Record(const std::string& path)
    : impl_(entered(ErrorCode::record, [&] { return std::make_unique<Impl>(Impl{engine::RunReader(path)}); })) {}
Record::~Record() = default;
Record::Record(Record&& other) noexcept = default;
Record& Record::operator=(Record&& other) noexcept = default;

const std::string& Record::status() const noexcept { return impl_->reader.status(); }
std::size_t Record::rows() const noexcept { return impl_->reader.rows(); }

RecordAttributes Record::attributes() const {
    return entered(ErrorCode::record, [&] { return attributes_from(impl_->reader.attributes()); });
}

std::vector<Column> Record::channels() const {
    return entered(ErrorCode::record, [&] {
        std::vector<Column> columns;
        for (const engine::ChannelInfo& row : impl_->reader.channels())
            columns.push_back({row.name, row.unit, row.description, static_cast<std::size_t>(row.width)});
        return columns;
    });
}

std::vector<double> Record::read(const std::string& channel, std::size_t first, std::size_t count) const {
    return entered(ErrorCode::record, [&] {
        if (first > rows() || count > rows() - first) {
            throw Error(ErrorCode::argument,
                        "rows " + std::to_string(first) + " to " + std::to_string(first + count) + " of " + std::to_string(rows()));
        }
        return impl_->reader.channel_rows(channel, first, count);
    });
}

std::vector<double> Record::read(const std::string& channel) const { return read(channel, 0, rows()); }
std::vector<double> Record::state_times() const {
    return entered(ErrorCode::record, [&] { return impl_->reader.state_times(); });
}

std::vector<double> Record::state(std::size_t number) const { return impl_->recorded(number).state; }
std::vector<std::uint8_t> Record::phases(std::size_t number) const { return impl_->recorded(number).phases; }

std::vector<Transition> Record::transitions() const {
    return entered(ErrorCode::record, [&] {
        std::vector<Transition> rows;
        for (const std::vector<double>& row : impl_->reader.table("transitions"))
            rows.push_back(
                {row[0], static_cast<int>(row[1]), static_cast<int>(row[2]), static_cast<int>(row[3]), static_cast<int>(row[4])});
        return rows;
    });
}

struct Recording::Impl final : public tasks::RunObserver {
    Simulation::Impl& simulation;
    const tasks::Scene& scene;
    tasks::RunOptions options;
    tasks::RunRecorder recorder;
    double next;  ///< outputs are numbered by their multiples of the interval

    Impl(Simulation::Impl& of, const tasks::Scene& what, const std::string& path, bool replace)
        : simulation(of),
          scene(what),
          options(writing(path, what, replace)),
          recorder(what, of.simulation(), options),
          next(std::ceil(std::max(0.0, of.simulation().time()) / what.run.output_interval - 1e-9)) {
        if (simulation.callbacks().recorder != nullptr) throw Error(ErrorCode::state, "the simulation is being recorded already");
        simulation.callbacks().recorder = this;
    }
    ~Impl() override { detach(); }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    [[nodiscard]] static tasks::RunOptions writing(const std::string& path, const tasks::Scene& scene, bool replace) {
        tasks::RunOptions made;
        made.file = {
            path,
            {.inputs = input_files(scene), .force = replace, .named = true, .advice = "remove it, name another file, or replace = true"}};
        return made;
    }

    void detach() noexcept {
        if (simulation.callbacks().recorder == this) simulation.callbacks().recorder = nullptr;
    }

    void output(double time, const tasks::Workspace& workspace, const tasks::Counters& counters) override {
        // Calls of advance_to() also end with an output, settling with one at t = 0 that the run repeats.
        const double number = time / scene.run.output_interval + 1e-9;
        if (simulation.simulation().needs_settling() || number < next) return;
        next = std::floor(number) + 1.0;
        api::translated(ErrorCode::record, [&] { recorder.output(time, workspace, counters); });
    }
    /// Whether a sample is due between outputs: only for means (record.means).
    [[nodiscard]] bool samples(double time) const noexcept override {
        return scene.run.means && !simulation.simulation().needs_settling() && recorder.samples(time);
    }
    void sample(double time, const tasks::Workspace& workspace, const tasks::Counters& counters) override {
        recorder.sample(time, workspace, counters);
    }
    void transition(const tasks::TransitionRecord& record) override {
        if (simulation.simulation().needs_settling()) return;
        api::translated(ErrorCode::record, [&] { recorder.transition(record); });
    }

    void finish(bool complete) {
        detach();
        const tasks::Simulation& now = simulation.simulation();
        tasks::RunReport report;
        if (!complete) report.fault.kind = tasks::FaultKind::cancelled;
        report.fault.time = now.time();
        report.step_setting = scene.run.step;
        recorder.finish(now, report);
    }
};

Recording::Recording(Simulation& simulation, const std::string& path, bool replace)
    : impl_(api::entered(ErrorCode::record, [&] {
          const Simulation::Impl::Scope scope(*simulation.impl_, Simulation::Impl::Scope::As::visitor);
          return std::make_unique<Impl>(*simulation.impl_, simulation.scene().data_->scene, path, replace);
      })) {}
Recording::~Recording() = default;
Recording::Recording(Recording&& other) noexcept = default;
Recording& Recording::operator=(Recording&& other) noexcept = default;

void Recording::finish(bool complete) {
    api::entered(ErrorCode::record, [&] {
        if (!impl_) throw Error(ErrorCode::state, "the recording has ended");
        const std::unique_ptr<Impl> ending = std::move(impl_);
        ending->finish(complete);
    });
}

std::vector<std::vector<std::string>> sums_of_quotient(const std::string& channel) {
    std::vector<std::vector<std::string>> sums;
    const tasks::QuotientChannels* of = tasks::quotient_channels_of(channel);
    if (of == nullptr) return sums;
    for (const auto& names : of->sums) sums.emplace_back(names.begin(), names.end());
    return sums;
}

}  // namespace v0
}  // namespace cvtflow
