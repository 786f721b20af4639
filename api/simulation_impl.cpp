#include "api/simulation_impl.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "engine/base/text.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"
#include "tasks/schedule/schedule.hpp"

namespace cvtflow::api {

namespace {

/// nullptr: none.
template <class Function>
[[nodiscard]] std::shared_ptr<const Function> shared(Function function) {
    return function ? std::make_shared<const Function>(std::move(function)) : nullptr;
}

/// Number of the first output after now [s].
[[nodiscard]] long next_output(double now, double interval) { return static_cast<long>(std::floor(now / interval + 1e-9)) + 1; }

}  // namespace

const model::StartState& SceneData::placed_start() const {
    return mutex_.guard([this]() -> const model::StartState& {
        if (!placed_start_) placed_start_ = model::start_state(scene.parameters);
        return *placed_start_;
    });
}

const engine::StateHead& SceneData::head() const {
    return mutex_.guard([this]() -> const engine::StateHead& {
        if (!head_) head_ = tasks::head_of(scene, tasks::method_of(scene));
        return *head_;
    });
}

ChannelReader::ChannelReader(const tasks::Simulation& simulation, const tasks::Scene& scene)
    : simulation_(simulation), followed_pin_(scene.run.followed_pin), observer_(simulation.workspace().variator) {
    for (const tasks::Channel& row : tasks::channels()) {
        if (!row.is(tasks::Channel::any_machine) && scene.parameters.detail.pulleys == model::PulleyDetail::absent) continue;
        rows_.push_back(&row);
        values_.emplace_back(static_cast<std::size_t>(row.width(simulation.workspace().variator.chain())));
    }
}

const tasks::Channel& ChannelReader::row(std::size_t index) const {
    if (index < rows_.size()) return *rows_[index];
    throw Error(ErrorCode::argument, "channel: number " + std::to_string(index) + " of " + std::to_string(rows_.size()));
}

std::size_t ChannelReader::find(std::string_view name) const {
    const auto found = std::ranges::find(rows_, name, &tasks::Channel::name);
    if (found != rows_.end()) return static_cast<std::size_t>(found - rows_.begin());
    std::vector<std::string> names;
    for (const tasks::Channel* row : rows_) names.emplace_back(row->name);
    throw Error(ErrorCode::argument,
                "channel: there is no '" + std::string(name) + "'" + engine::did_you_mean(engine::closest(name, names)));
}

std::span<const double> ChannelReader::read(std::size_t index) {
    const tasks::Channel& channel = row(index);
    const tasks::Workspace& workspace = simulation_.workspace();
    const tasks::Counters& counters = simulation_.part().counters();
    const bool chain = channel.needs_chain(counters);
    if (observation_ == nullptr || (chain && !chain_observed_)) {
        observation_ =
            &(chain ? workspace.observed_by(observer_, simulation_.time()) : workspace.shafts_observed_by(observer_, simulation_.time()));
        chain_observed_ = chain;
    }
    channel.read({*observation_, workspace, counters, followed_pin_, observer_}, values_[index].data());
    return values_[index];
}

void HostCallbacks::on_output(double now, double interval, std::function<void()> callback) {
    if (callback && !(interval > 0.0 && std::isfinite(interval)))
        throw Error(ErrorCode::argument, "on_output: the interval must be positive");
    output_ = shared(std::move(callback));
    interval_ = interval;
    if (output_) outputs_ = next_output(now, interval_);
}

void HostCallbacks::on_transition(std::function<void(const cvtflow_transition&)> callback) { transition_ = shared(std::move(callback)); }

void HostCallbacks::restart(double now) {
    transitions_.clear();
    pulled_.clear();
    if (output_) outputs_ = next_output(now, interval_);
}

void HostCallbacks::transition(const tasks::TransitionRecord& record) {
    if (recorder != nullptr) recorder->transition(record);
    const cvtflow_transition now{sizeof now, record.pin, record.tip, static_cast<int>(record.from), static_cast<int>(record.to),
                                 0,          record.time};
    if (transition_) transitions_.push_back(now);
    if (pulls_) pulled_.push_back(now);
}

double HostCallbacks::next_stop(double now, double until) const noexcept {
    double stop = until;
    if (output_) stop = std::min(stop, static_cast<double>(outputs_) * interval_);
    if (transition_) stop = std::min(stop, now + scene_interval_);
    return stop;
}

/// The host's callbacks may replace themselves, so they are held while they are called.
void HostCallbacks::deliver(double now, FloatingDefaults& defaults) {
    happened_.clear();
    std::swap(happened_, transitions_);
    for (const cvtflow_transition& transition : happened_) {
        const auto callback = transition_;
        if (!callback) continue;
        const FloatingDefaults::Outside outside(defaults);
        (*callback)(transition);
    }
    now += 1e-9 * scene_interval_;
    if (!output_ || now < static_cast<double>(outputs_) * interval_) return;
    outputs_ = static_cast<long>(std::floor(now / interval_)) + 1;
    const auto callback = output_;
    const FloatingDefaults::Outside outside(defaults);
    (*callback)();
}

void require_threads(int count, int min) {
    constexpr int max = 1024;
    if (count < min || count > max)
        throw Error(ErrorCode::argument, "threads: " + std::to_string(count) + " is outside [" + std::to_string(min) + ", 1024]");
}

double step_length(const tasks::Simulation& simulation, const tasks::Scene& scene) {
    const double interval = scene.run.output_interval;
    if (scene.run.step.automatic()) return simulation.step() > 0.0 ? simulation.step() : automatic_step(simulation);
    return interval / std::max(1.0, std::ceil(interval / scene.run.step * (1.0 - 1e-12)));
}

namespace {

/// Schedule of a simulation: one thread needs no executor but the plain loop.
[[nodiscard]] tasks::Schedule schedule_of(const tasks::Scene& scene, Threads threads, int segments) {
    const int links = tasks::max_segments(scene.parameters);
    require_threads(threads.count(), threads.way() == Threads::Way::private_arena ? 0 : 1);
    if (segments < 0 || segments > links) {
        throw Error(ErrorCode::argument, "segments: " + std::to_string(segments) + " is outside [0, " + std::to_string(links) +
                                             (links == 1 ? "]: rigid pins are evaluated at once" : "], the links of this chain"));
    }
    tasks::Schedule schedule;
    schedule.threads = links == 1 ? 1 : threads.count() == 0 ? tasks::usable_threads() : threads.count();
    schedule.executor = schedule.threads == 1 ? "serial" : "flow";
    schedule.present_arena = threads.way() == Threads::Way::current_arena;
    schedule.segments = segments > 0 ? segments : std::min(schedule.threads, links);
    schedule.balanced = scene.run.partition == tasks::PartitionKind::balanced;
    schedule.assembly.kind = scene.run.assembly;
    return schedule;
}

/// A step that would do, where the step is the likely reason of a fault.
[[nodiscard]] std::string advice(const tasks::Simulation& simulation, tasks::FaultKind kind) {
    using tasks::FaultKind;
    if (kind != FaultKind::non_finite && kind != FaultKind::blow_up && kind != FaultKind::penetration && kind != FaultKind::left_sheave)
        return "";
    const double stable = largest_step(simulation).step;
    if (!(stable > 0.0 && std::isfinite(stable))) return "";
    return "; " + tasks::stable_text(simulation.method().name(), stable);
}

}  // namespace

HostSimulation::HostSimulation(std::shared_ptr<const SceneData> scene, Threads threads, int segments, const model::StartState* start)
    : scene_(std::move(scene)),
      threads_(threads),
      segments_(segments),
      schedule_(schedule_of(scene_->scene, threads, segments)),
      simulation_(scene_->scene, schedule_, nullptr,
                  start == nullptr && scene_->scene.state_file.empty() ? &scene_->placed_start() : start),
      channels_(simulation_, scene_->scene),
      callbacks_(scene_->scene.run.output_interval),
      start_differences_(simulation_.start_differences()) {}

HostSimulation::Scope::Scope(HostSimulation& of, As as) : of_(of), entered_(of.entry_.enter()) {
    if (entered_) return;
    const bool callback = of.entry_.mine();
    if (callback && as == As::visitor) return;
    throw Error(ErrorCode::busy, callback ? "a simulation cannot be stepped or replaced from its own callback"
                                          : "the simulation is in use by another thread");
}

HostSimulation::Scope::~Scope() {
    if (entered_) of_.entry_.leave();
}

/// A process that was forked off after the first threaded step has the memory but not the threads.
void HostSimulation::require_own_process() {
    if (schedule_.threads == 1) return;
    const long here = engine::process_number();
    if (process_ == 0) process_ = here;
    if (process_ != here) {
        throw Error(ErrorCode::forked,
                    "this simulation used threads before the process was forked; create a new one without threads here, and set its state");
    }
}

void HostSimulation::advance(double until, long steps) {
    if (!std::isfinite(until)) throw Error(ErrorCode::argument, "time: not a finite number");
    FloatingDefaults defaults;
    const Scope scope(*this, Scope::As::stepper);
    // A step may end after the requested time; requesting the same time again is allowed.
    const double now = simulation_.time(), tolerance = 1e-9 * scene().run.output_interval;
    if (until < now && until < std::min(last_stop_, now - step_length(simulation_, scene())) - tolerance) {
        throw Error(ErrorCode::argument, "time: " + tasks::number_text(until) + " s is before " + tasks::number_text(now) +
                                             " s, the present time; to go back, set a state");
    }
    require_own_process();
    last_stop_ = steps > 0 ? std::numeric_limits<double>::infinity() : until;
    while (simulation_.time() < until - tolerance) {
        if (cancel_.withdraw()) throw Error(ErrorCode::cancelled, "cancelled");
        const long steps_before = simulation_.part().counters().steps;
        channels_.changed();
        const tasks::Fault fault = translated(ErrorCode::internal, [&] {
            return simulation_.advance({.until = callbacks_.next_stop(simulation_.time(), until), .steps = steps, .rows_between = true},
                                       callbacks_, cancel_);
        });
        callbacks_.deliver(simulation_.time(), defaults);
        if (fault.kind == tasks::FaultKind::cancelled) cancel_.withdraw();
        if (steps > 0 && (simulation_.part().counters().steps != steps_before || !fault)) return;
        if (fault) throw Error(code_of(fault), fault.message() + advice(simulation_, fault.kind));
    }
}

std::unique_ptr<HostSimulation> HostSimulation::copy() {
    const Scope scope(*this, Scope::As::visitor);
    const tasks::IntegrationState& now = simulation_.integration_state();
    const model::StartState start{now.state, now.phases, {}, 0.0};
    auto other = std::make_unique<HostSimulation>(scene_, threads_, segments_, &start);
    other->take(now);
    other->start_differences_ = start_differences_;
    return other;
}

std::vector<std::byte> HostSimulation::state() {
    const Scope scope(*this, Scope::As::visitor);
    engine::StateHead head = scene_->head();
    head.balance_error_ratio = simulation_.balance_error_ratio();
    auto& now = const_cast<tasks::IntegrationState&>(simulation_.integration_state());  // which an archive that writes does not change
    const std::size_t about = head.scene.size() + now.energy.size() + now.method.size() + 24 * (now.state.size() + now.phases.size());
    const auto visit = [&](engine::Archive& archive) { head.visit(archive), now.visit(archive); };
    return engine::state_of(visit, about);
}

void HostSimulation::rhs(double t, const double* x, double* out) {
    const Scope scope(*this, Scope::As::visitor);
    const tasks::Workspace& workspace = simulation_.workspace();
    if (!slope_) slope_.emplace(workspace.variator, workspace.rule);
    (*slope_)(t, x, out);
}

void HostSimulation::hold(const model::HeldInputs& held) {
    simulation_.hold(held);
    channels_.changed();
}

std::vector<std::string> HostSimulation::notices() const {
    std::vector<std::string> lines = start_differences_;
    std::ranges::copy(tasks::idle_keys(scene()), std::back_inserter(lines));
    const double ratio = simulation_.balance_error_ratio();
    if (!(ratio <= 1.0)) lines.push_back(tasks::unreliable_text(ratio, scene().run.step, simulation_.step()));
    const engine::ThreadShortage threads = engine::thread_shortage();
    if (threads.requested > 0)
        lines.push_back("threads: available " + std::to_string(threads.had) + " of " + std::to_string(threads.requested));
    return lines;
}

std::span<const std::byte> HostSimulation::fields(std::span<const std::byte> bytes) {
    try {
        return engine::fields_of_state(bytes);
    } catch (const engine::ArchiveError& error) {
        throw Error(ErrorCode::state, std::string("saved state: ") + error.what());
    }
}

void HostSimulation::restore(std::span<const std::byte> bytes) {
    engine::Archive archive = engine::Archive::from(fields(bytes));
    engine::StateHead head;
    tasks::IntegrationState state;
    translated(ErrorCode::state, [&] {
        head.visit(archive);
        if (head.scene_hash == scene_->head().scene_hash) state.visit(archive);
    });
    if (head.scene_hash != scene_->head().scene_hash)
        throw Error(ErrorCode::state, "saved state: it belongs to another scene, method or step");
    take(std::move(state));
}

void HostSimulation::take(tasks::IntegrationState state) {
    const Scope scope(*this, Scope::As::stepper);
    translated(ErrorCode::state, [&] { simulation_.restore(std::move(state)); });
    channels_.changed();
    last_stop_ = std::numeric_limits<double>::infinity();
    callbacks_.restart(simulation_.time());
}

}  // namespace cvtflow::api
