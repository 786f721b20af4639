#include <algorithm>
#include <cmath>
#include <cvtflow/simulation.hpp>
#include <cvtflow/snapshot.hpp>
#include <utility>

#include "api/simulation_impl.hpp"
#include "engine/base/text.hpp"
#include "engine/thread/published_numbers.hpp"
#include "engine/thread/worker_threads.hpp"
#include "tasks/run/simulation.hpp"
#include "tasks/scene/parameter_table.hpp"
#include "tasks/scene/units.hpp"

namespace cvtflow {
inline namespace v0 {

using api::entered;

State State::from_bytes(std::span<const std::byte> bytes) {
    return entered(ErrorCode::state, [&] {
        api::check_state_bytes(bytes);
        State state;
        state.bytes_.assign(bytes.begin(), bytes.end());
        return state;
    });
}

Simulation::Simulation(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}

Simulation::Simulation(const Scene& scene, Threads threads, int segments)
    : impl_(entered(ErrorCode::start_state, [&] { return std::make_unique<Impl>(scene, threads, segments); })) {}

Simulation::~Simulation() {
    const api::FloatingDefaults defaults;
    Impl::end(std::move(impl_));
}
Simulation::Simulation(Simulation&& other) noexcept : impl_(std::move(other.impl_)) {
    if (impl_) impl_->moved();
}
Simulation& Simulation::operator=(Simulation&& other) noexcept {
    if (this == &other) return *this;
    const api::FloatingDefaults defaults;
    Impl::end(std::exchange(impl_, std::move(other.impl_)));
    if (impl_) impl_->moved();
    return *this;
}

Simulation Simulation::copy() const {
    return entered(ErrorCode::internal, [&] { return Simulation(impl_->copy()); });
}

const Scene& Simulation::scene() const noexcept { return impl_->scene(); }
double Simulation::time() const noexcept { return impl_->simulation().time(); }
const std::string& Simulation::method() const noexcept { return impl_->simulation().method().name(); }
double Simulation::step_length() const noexcept {
    const api::FloatingDefaults defaults;
    return api::step_length(impl_->simulation(), impl_->scene().data_->scene);
}
void Simulation::advance_to(double t) { impl_->advance(*this, t, 0); }
void Simulation::step() { impl_->advance(*this, 1e300, 1); }
void Simulation::cancel() noexcept { impl_->cancel_.request(); }

State Simulation::state() const {
    return impl_->visited([&] {
        const tasks::Simulation& now = impl_->simulation();
        State state;
        state.bytes_ = api::write_state_bytes(scene().data_->fingerprint(), now.workspace().variator.pulleys().torques().held(),
                                              now.integration_state());
        return state;
    });
}

void Simulation::set_state(const State& state) {
    entered(ErrorCode::internal, [&] { impl_->restore(api::read_state_bytes(state.bytes_)); });
}

std::uint64_t Simulation::hash() const {
    return entered(ErrorCode::internal, [&] { return impl_->simulation().hash(); });
}

std::size_t Simulation::size() const noexcept { return static_cast<std::size_t>(impl_->simulation().workspace().layout().size()); }
std::span<const double> Simulation::unknowns() const noexcept { return {impl_->simulation().workspace().state(), size()}; }
void Simulation::rhs(double t, std::span<const double> x, std::span<double> out) {
    if (x.size() != size() || out.size() != size()) {
        throw Error(ErrorCode::argument, "rhs: spans of " + std::to_string(x.size()) + " and " + std::to_string(out.size()) +
                                             " numbers for " + std::to_string(size()) + " unknowns");
    }
    impl_->visited([&] {
        const tasks::Workspace& workspace = impl_->simulation().workspace();
        if (!impl_->slope_) impl_->slope_.emplace(workspace.variator, workspace.rule);
        (*impl_->slope_)(t, x.data(), out.data());
    });
}

std::size_t Simulation::channels() const noexcept { return impl_->channels().size(); }
ChannelInfo Simulation::channel_info(std::size_t index) const {
    return entered(ErrorCode::internal, [&] {
        const tasks::Channel& row = impl_->channels().row(index);
        return ChannelInfo{row.name, row.unit, row.description,
                           static_cast<std::size_t>(row.width(impl_->simulation().workspace().variator.chain()))};
    });
}
std::size_t Simulation::find_channel(const std::string& name) const {
    return entered(ErrorCode::internal, [&] { return impl_->channels().find(name); });
}
std::span<const double> Simulation::channel(std::size_t index) {
    return impl_->visited([&] { return impl_->channels().read(index); });
}
std::span<const double> Simulation::channel(const std::string& name) { return channel(find_channel(name)); }

Counters Simulation::counters() const noexcept {
    const tasks::Counters& so_far = impl_->simulation().part().counters();
    return {so_far.steps, so_far.evaluations, so_far.detected, so_far.truncated, so_far.suppressed};
}
std::vector<std::string> Simulation::notices() const {
    return entered(ErrorCode::internal, [&] {
        std::vector<std::string> lines = impl_->start_differences_;
        const tasks::Simulation& now = impl_->simulation();
        const double ratio = now.balance_error_ratio();
        if (!(ratio <= 1.0)) lines.push_back(tasks::unreliable_text(ratio, impl_->data().run.step, now.step()));
        const engine::ThreadShortage threads = engine::thread_shortage();
        if (threads.requested > 0)
            lines.push_back("threads: available " + std::to_string(threads.had) + " of " + std::to_string(threads.requested));
        return lines;
    });
}
Energy Simulation::energy() const noexcept {
    const api::FloatingDefaults defaults;
    const tasks::EnergyBalance balance = impl_->simulation().workspace().energy.balance();
    const double balance_error_ratio = impl_->simulation().balance_error_ratio();
    return {balance.residual(), balance.loss, balance_error_ratio, balance_error_ratio <= 1.0};
}
double Simulation::largest_stable_step() {
    return impl_->visited([&] { return largest_step(impl_->simulation()).step; });
}

void Simulation::on_output(double interval, std::function<void(Simulation&)> callback) {
    impl_->visited([&] { impl_->callbacks().on_output(time(), interval, std::move(callback)); });
}
void Simulation::on_transition(std::function<void(Simulation&, const Transition&)> callback) {
    impl_->visited([&] { impl_->callbacks().on_transition(std::move(callback)); });
}

namespace {

using model::InputRow;

constexpr double largest_angle = 1e9;  // [rad]

static_assert(static_cast<int>(Input::pressure_driven) + 1 == static_cast<int>(model::host_inputs));
static_assert(static_cast<int>(Input::load_angle) == static_cast<int>(model::Input::load_angle));

[[nodiscard]] const InputRow& input_row(Input input) {
    const auto number = static_cast<int>(input);
    if (number < 0 || number >= static_cast<int>(model::host_inputs))
        throw Error(ErrorCode::argument, "input: there is no number " + std::to_string(number));
    return model::input_table[static_cast<std::size_t>(number)];
}

[[nodiscard]] const InputRow& input_row(Input input, const tasks::Scene& scene) {
    const InputRow& row = input_row(input);
    if (scene.parameters.detail.pulleys == model::PulleyDetail::absent)
        throw Error(ErrorCode::argument, std::string(row.key) + ": this scene has no pulleys");
    if (!row.acts(scene.parameters)) throw Error(ErrorCode::argument, std::string(row.key) + ": needs " + row.needs);
    return row;
}

/// @param value [unit of the input] @throws Error (argument)
void require_in_range(const InputRow& row, double value) {
    if (row.is_angle()) {
        if (!(std::abs(value) <= largest_angle)) throw Error(ErrorCode::argument, std::string(row.name) + ": beyond 1e9 rad");
        return;
    }
    const tasks::Parameter& range = *tasks::find_parameter(row.key);
    if (value >= range.min && value <= range.max) return;
    throw Error(ErrorCode::argument, std::string(row.key) + ": " + tasks::number_text(value) + " is outside [" +
                                         tasks::number_text(range.min) + ", " + tasks::number_text(range.max) + "] " +
                                         std::string(range.unit));
}

}  // namespace

InputInfo input_info(Input input) {
    return api::entered(ErrorCode::internal, [&] {
        const InputRow& row = input_row(input);
        if (row.is_angle()) return InputInfo{row.name, "rad", "Angle that the far end of the coupling has turned since t = 0."};
        const tasks::Parameter& key = *tasks::find_parameter(row.key);
        return InputInfo{row.name, key.unit, key.meaning};
    });
}

void Simulation::set_input(Input input, double value) {
    impl_->visited([&] {
        const InputRow& row = input_row(input, impl_->data());
        require_in_range(row, value);
        const model::PulleyModel& pulleys = impl_->simulation().workspace().variator.pulleys();
        model::HeldInputs held = pulleys.torques().held();
        if (row.turns != InputRow::none) {  // the reference turns on from where it is
            model::ReferenceAngle& reference = held.reference[static_cast<std::size_t>(row.turns)];
            if (row.is_angle() && !held.coupled)
                throw Error(ErrorCode::argument, std::string(row.name) + ": the coupling acts from t = 0 on");
            reference.angle = row.is_angle() ? reference.zero + value : pulleys.torques().reference_angle(time(), row.turns);
            reference.since = time();
        }
        if (!row.is_angle()) held.values[static_cast<model::Input>(input)] = value;
        impl_->simulation_.hold(held);
        impl_->channels().changed();
    });
}

double Simulation::input(Input input) const {
    return entered(ErrorCode::internal, [&] {
        const InputRow& row = input_row(input, impl_->data());
        const model::PulleyModel& pulleys = impl_->simulation().workspace().variator.pulleys();
        if (row.is_angle()) {
            const bool acts = pulleys.torques().held().coupled;
            return acts ? pulleys.torques().reference_angle(time(), row.turns) -
                              pulleys.torques().held().reference[static_cast<std::size_t>(row.turns)].zero
                        : 0.0;
        }
        return pulleys.torques().held().values.at(static_cast<model::Input>(input), *row.table(impl_->data().parameters),
                                                  std::max(time(), 0.0));
    });
}

struct Snapshot::Impl {
    std::vector<std::size_t> channels;
    std::vector<double> taken;
    engine::PublishedNumbers published;
};

Snapshot::Snapshot(Simulation& simulation, const std::vector<std::string>& channels) {
    std::vector<std::size_t> numbers;
    std::size_t size = 1;
    for (const std::string& name : channels) {
        numbers.push_back(simulation.find_channel(name));
        size += simulation.channel_info(numbers.back()).width;
    }
    impl_.reset(new Impl{std::move(numbers), std::vector<double>(size), engine::PublishedNumbers(size)});
    take(simulation);
}

Snapshot::~Snapshot() = default;

void Snapshot::take(Simulation& simulation) {
    std::vector<double>& taken = impl_->taken;
    taken[0] = simulation.time();
    std::size_t at = 1;
    for (const std::size_t channel : impl_->channels)
        for (const double value : simulation.channel(channel)) taken.at(at++) = value;
    impl_->published.publish(taken);
}

std::size_t Snapshot::size() const noexcept { return impl_->taken.size(); }

void Snapshot::read(std::span<double> out) const {
    if (out.size() != size())
        throw Error(ErrorCode::argument, "snapshot: " + std::to_string(out.size()) + " numbers for " + std::to_string(size()));
    impl_->published.read(out);
}

std::vector<double> Snapshot::read() const {
    std::vector<double> values(size());
    read(values);
    return values;
}

}  // namespace v0
}  // namespace cvtflow
