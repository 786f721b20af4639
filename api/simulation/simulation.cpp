#include <cvtflow/simulation.hpp>
#include <utility>

#include "api/host/translate.hpp"
#include "api/simulation/simulation_impl.hpp"

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
const std::string& Simulation::method() const noexcept { return impl_->simulation().method_name(); }
double Simulation::step_length() const noexcept {
    const api::FloatingDefaults defaults;
    return impl_->step_length();
}
void Simulation::advance_to(double t) { impl_->advance(*this, t, 0); }
void Simulation::step() { impl_->advance(*this, 1e300, 1); }
void Simulation::cancel() noexcept { impl_->cancel(); }

State Simulation::state() const {
    return entered(ErrorCode::internal, [&] {
        const Impl::Scope scope(*impl_, Impl::Scope::As::visitor);
        State state;
        state.bytes_ = api::write_state_bytes(impl_->record());
        return state;
    });
}

void Simulation::set_state(const State& state) {
    entered(ErrorCode::internal, [&] { impl_->restore(api::read_state_bytes(state.bytes_)); });
}

std::uint64_t Simulation::hash() const {
    return entered(ErrorCode::internal, [&] { return impl_->simulation().hash(); });
}
void Simulation::set_input(Input input, double value) {
    entered(ErrorCode::internal, [&] { impl_->set_input(input, value); });
}
double Simulation::input(Input input) const {
    return entered(ErrorCode::internal, [&] { return impl_->input(input); });
}

std::size_t Simulation::size() const noexcept { return static_cast<std::size_t>(impl_->simulation().variator().layout().size()); }
std::span<const double> Simulation::unknowns() const noexcept { return {impl_->simulation().state(), size()}; }
void Simulation::rhs(double t, std::span<const double> x, std::span<double> out) {
    entered(ErrorCode::internal, [&] { impl_->rhs(t, x, out); });
}

std::size_t Simulation::channels() const noexcept { return impl_->channels(); }
ChannelInfo Simulation::channel_info(std::size_t index) const {
    return entered(ErrorCode::internal, [&] {
        const tasks::Channel& row = impl_->channel_row(index);
        return ChannelInfo{row.name, row.unit, row.description,
                           static_cast<std::size_t>(row.width(impl_->simulation().variator().chain()))};
    });
}
std::size_t Simulation::find_channel(const std::string& name) const {
    return entered(ErrorCode::internal, [&] { return impl_->find_channel(name); });
}
std::span<const double> Simulation::channel(std::size_t index) {
    return entered(ErrorCode::internal, [&] { return impl_->channel(index); });
}
std::span<const double> Simulation::channel(const std::string& name) { return channel(find_channel(name)); }

Counters Simulation::counters() const noexcept { return impl_->counters(); }
std::vector<std::string> Simulation::notices() const {
    return entered(ErrorCode::internal, [&] { return impl_->notices(); });
}
Energy Simulation::energy() const noexcept {
    const api::FloatingDefaults defaults;
    return impl_->energy();
}
double Simulation::largest_stable_step() {
    return entered(ErrorCode::internal, [&] { return impl_->largest_stable_step(); });
}

void Simulation::on_output(double interval, std::function<void(Simulation&)> callback) {
    entered(ErrorCode::internal, [&] { impl_->on_output(interval, std::move(callback)); });
}
void Simulation::on_transition(std::function<void(Simulation&, const Transition&)> callback) {
    entered(ErrorCode::internal, [&] {
        const Impl::Scope scope(*impl_, Impl::Scope::As::visitor);
        impl_->on_transition(std::move(callback));
    });
}

}  // namespace v0
}  // namespace cvtflow
