/// The C interface to simulations.

#include <algorithm>
#include <cstring>
#include <utility>

#include "api/c/boundary.hpp"

using namespace cvtflow;

namespace {

[[nodiscard]] cvtflow::Threads threads_of(const cvtflow_options* options) {
    if (options == nullptr || options->way == CVTFLOW_CALLER) return Threads::caller();
    if (options->way == CVTFLOW_CURRENT_ARENA) return Threads::current_arena(options->threads);
    if (options->way == CVTFLOW_PRIVATE_ARENA) return Threads::private_arena(options->threads);
    throw Error(ErrorCode::argument, "way: there is no number " + std::to_string(options->way));
}

/// Answer to a question that cannot fail; `nothing` for NULL.
template <class T, class Question>
T ask(const cvtflow_simulation* simulation, T nothing, Question&& question) noexcept {
    try {
        return simulation != nullptr ? question(*simulation->simulation) : nothing;
    } catch (...) {
        return nothing;
    }
}

[[nodiscard]] const tasks::Counters& counters_of(const api::HostSimulation& s) { return s.simulation().part().counters(); }

/// A call that may call the host back: a simulation that is destroyed meanwhile ends with the last of them.
class Visit {
public:
    explicit Visit(cvtflow_simulation& handle) noexcept : handle_(handle) { handle.life.enter(); }
    ~Visit() { leave(handle_); }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

    static void leave(cvtflow_simulation& handle) noexcept {
        if (handle.life.leave()) delete &handle;
    }

private:
    cvtflow_simulation& handle_;
};

/// Runs a callback of a step, unless the simulation has been destroyed. @throws Error (callback, cancelled), which ends the call
template <class Callback>
void call_back(const cvtflow_simulation& handle, const char* name, Callback&& callback) {
    const int status = handle.life.given_up() ? 0 : callback();
    if (handle.life.given_up()) throw Error(ErrorCode::cancelled, "the simulation was destroyed while it was stepping");
    if (status != 0) throw Error(ErrorCode::callback, std::string("the callback on ") + name + " requested the end");
}

void log(const cvtflow_simulation& handle, const std::string& line) {
    if (handle.log != nullptr && !handle.life.given_up()) handle.log(line.c_str(), handle.log_user);
}

void log_notices(cvtflow_simulation& handle) {
    if (handle.log == nullptr || handle.life.given_up()) return;
    for (const std::string& line : handle.simulation->notices()) {
        if (std::find(handle.logged.begin(), handle.logged.end(), line) != handle.logged.end()) continue;
        handle.logged.push_back(line);
        log(handle, line);
    }
}

/// Runs `action` and logs its errors.
template <class Action>
void logged(cvtflow_simulation& handle, Action&& action) {
    const Visit visit(handle);
    try {
        action(*handle.simulation);
    } catch (const std::exception& error) {
        log(handle, error.what());
        throw;
    }
    log_notices(handle);
}

}  // namespace

extern "C" {

cvtflow_code cvtflow_create(const cvtflow_scene* scene, const cvtflow_options* options, cvtflow_simulation** simulation,
                            cvtflow_message* message) {
    const auto action = [&] {
        if (options != nullptr && options->size < sizeof(cvtflow_options))
            throw Error(ErrorCode::argument, "options: its size is not set (CVTFLOW_INIT)");
        cvtflow_simulation*& place = api::given(simulation, "simulation");
        const int segments = options != nullptr ? options->segments : 0;
        place =
            new cvtflow_simulation{std::make_unique<api::HostSimulation>(api::given(scene, "scene").data, threads_of(options), segments)};
    };
    return api::guarded(message, action, ErrorCode::start_state);
}

cvtflow_code cvtflow_copy(const cvtflow_simulation* from, cvtflow_simulation** copy, cvtflow_message* message) {
    return api::guarded(message, [&] {
        cvtflow_simulation*& place = api::given(copy, "copy");
        place = new cvtflow_simulation{api::given(from, "from").simulation->copy()};
    });
}

void cvtflow_destroy(cvtflow_simulation* simulation) {
    if (simulation == nullptr || !simulation->life.give_up()) return;
    const api::FloatingDefaults defaults;
    simulation->simulation->cancel();
    Visit::leave(*simulation);
}

double cvtflow_time(const cvtflow_simulation* simulation) {
    return ask(simulation, 0.0, [](const auto& s) { return s.simulation().time(); });
}

const char* cvtflow_method(const cvtflow_simulation* simulation) {
    return ask(simulation, "", [](const auto& s) { return s.simulation().method().name().c_str(); });
}

double cvtflow_step_length(const cvtflow_simulation* simulation) {
    const api::FloatingDefaults defaults;
    return ask(simulation, 0.0, [](const auto& s) { return api::step_length(s.simulation(), s.scene()); });
}

cvtflow_code cvtflow_advance_to(cvtflow_simulation* simulation, double time, cvtflow_message* message) {
    return api::caught(message, [&] { logged(api::given(simulation, "simulation"), [&](auto& s) { s.advance(time, 0); }); });
}

cvtflow_code cvtflow_step(cvtflow_simulation* simulation, cvtflow_message* message) {
    return api::caught(message, [&] { logged(api::given(simulation, "simulation"), [](auto& s) { s.advance(1e300, 1); }); });
}

void cvtflow_cancel(cvtflow_simulation* simulation) {
    if (simulation != nullptr) simulation->simulation->cancel();
}

cvtflow_code cvtflow_largest_stable_step(cvtflow_simulation* simulation, double* step, cvtflow_message* message) {
    return api::guarded(message, [&] {
        api::HostSimulation& s = api::of(simulation);
        api::given(step, "step") = s.visited([&] { return largest_step(s.simulation()).step; });
    });
}

cvtflow_code cvtflow_state_get(const cvtflow_simulation* simulation, void* bytes, size_t* size, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const std::vector<std::byte> state = api::of(simulation).state();
        const size_t room = std::exchange(api::given(size, "size"), state.size());
        if (bytes == nullptr) return;
        if (room < *size)
            throw Error(ErrorCode::argument, "size: " + std::to_string(room) + " bytes for a state of " + std::to_string(*size));
        std::memcpy(bytes, state.data(), *size);
    });
}

cvtflow_code cvtflow_state_set(cvtflow_simulation* simulation, const void* bytes, size_t size, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const auto* first = static_cast<const std::byte*>(bytes);
        api::of(simulation).restore(api::given(first, size, "bytes"));
    });
}

cvtflow_code cvtflow_state_check(const void* bytes, size_t size, cvtflow_message* message) {
    const auto* first = static_cast<const std::byte*>(bytes);
    return api::guarded(message, [&] { static_cast<void>(api::HostSimulation::fields(api::given(first, size, "bytes"))); });
}

uint64_t cvtflow_hash(const cvtflow_simulation* simulation) {
    return ask(simulation, uint64_t{0}, [](const auto& s) { return s.simulation().hash(); });
}

cvtflow_code cvtflow_input_set(cvtflow_simulation* simulation, int32_t input, double value, cvtflow_message* message) {
    return api::guarded(message, [&] { api::set_input(api::of(simulation), input, value); });
}

cvtflow_code cvtflow_input_get(const cvtflow_simulation* simulation, int32_t input, double* value, cvtflow_message* message) {
    return api::guarded(message, [&] { api::given(value, "value") = api::input(api::of(simulation), input); });
}

size_t cvtflow_size(const cvtflow_simulation* simulation) {
    return ask(simulation, size_t{0}, [](const auto& s) { return s.size(); });
}

const double* cvtflow_unknowns(const cvtflow_simulation* simulation) {
    return ask<const double*>(simulation, nullptr, [](const auto& s) { return s.simulation().workspace().state(); });
}

cvtflow_code cvtflow_rhs(cvtflow_simulation* simulation, double time, const double* x, double* out, size_t size, cvtflow_message* message) {
    return api::guarded(message, [&] {
        api::HostSimulation& s = api::of(simulation);
        if (size != s.size())
            throw Error(ErrorCode::argument, "rhs: " + std::to_string(size) + " numbers for " + std::to_string(s.size()) + " unknowns");
        s.rhs(time, &api::given(x, "x"), &api::given(out, "out"));
    });
}

size_t cvtflow_channel_count(const cvtflow_simulation* simulation) {
    return ask(simulation, size_t{0}, [](const auto& s) { return s.channels().size(); });
}

cvtflow_code cvtflow_channel_describe(const cvtflow_simulation* simulation, size_t channel, cvtflow_channel_info* info,
                                      cvtflow_message* message) {
    return api::guarded(message, [&] {
        const api::HostSimulation& s = api::of(simulation);
        const tasks::Channel& row = s.channels().row(channel);
        const auto width = static_cast<size_t>(row.width(s.simulation().workspace().variator.chain()));
        api::fill_versioned(info, "info", {sizeof *info, 0, row.name.data(), row.unit.data(), row.description.data(), width});
    });
}

cvtflow_code cvtflow_channel_find(const cvtflow_simulation* simulation, const char* name, size_t* channel, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const api::HostSimulation& s = api::of(simulation);
        api::given(channel, "channel") = s.channels().find(&api::given(name, "name"));
    });
}

cvtflow_code cvtflow_channel_values(cvtflow_simulation* simulation, size_t channel, const double** values, size_t* width,
                                    cvtflow_message* message) {
    return api::guarded(message, [&] {
        api::HostSimulation& s = api::of(simulation);
        const std::span<const double> now = s.visited([&] { return s.channels().read(channel); });
        api::given(values, "values") = now.data();
        if (width != nullptr) *width = now.size();
    });
}

cvtflow_code cvtflow_counters_get(const cvtflow_simulation* simulation, cvtflow_counters* counters) {
    return api::guarded(nullptr, [&] {
        const tasks::Counters& now = counters_of(api::of(simulation));
        api::fill_versioned(counters, "counters",
                            {sizeof *counters, 0, now.steps, now.evaluations, now.detected, now.truncated, now.suppressed});
    });
}

cvtflow_code cvtflow_notices(const cvtflow_simulation* simulation, cvtflow_log_function function, void* user, cvtflow_message* message) {
    return api::caught(message, [&] {
        if (function == nullptr) throw Error(ErrorCode::argument, "function is NULL");
        const api::HostSimulation& s = api::of(simulation);
        for (const std::string& line : api::entered(ErrorCode::internal, [&] { return s.notices(); })) function(line.c_str(), user);
    });
}

cvtflow_code cvtflow_on_log(cvtflow_simulation* simulation, cvtflow_log_function function, void* user, cvtflow_message* message) {
    return api::guarded(message, [&] {
        cvtflow_simulation& handle = api::given(simulation, "simulation");
        handle.log = function;
        handle.log_user = user;
        handle.logged.clear();
    });
}

cvtflow_code cvtflow_input_describe(int32_t input, cvtflow_channel_info* info, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const api::InputText row = api::input_text(input);
        api::fill_versioned(info, "info", {sizeof *info, 0, row.name.data(), row.unit.data(), row.description.data(), 1});
    });
}

cvtflow_code cvtflow_energy_get(const cvtflow_simulation* simulation, cvtflow_energy* energy) {
    return api::guarded(nullptr, [&] {
        const tasks::Simulation& now = api::of(simulation).simulation();
        const tasks::EnergyBalance balance = now.workspace().energy.balance();
        const double ratio = now.balance_error_ratio();
        api::fill_versioned(energy, "energy", {sizeof *energy, ratio <= 1.0 ? 1 : 0, balance.residual(), balance.loss, ratio});
    });
}

cvtflow_code cvtflow_on_output(cvtflow_simulation* simulation, double interval, cvtflow_output_function function, void* user,
                               cvtflow_message* message) {
    return api::guarded(message, [&] {
        api::HostSimulation& s = api::of(simulation);
        std::function<void()> call;
        if (function != nullptr) call = [=] { call_back(*simulation, "output", [&] { return function(simulation, user); }); };
        s.visited([&] { s.callbacks().on_output(s.simulation().time(), interval, std::move(call)); });
    });
}

cvtflow_code cvtflow_on_transition(cvtflow_simulation* simulation, cvtflow_transition_function function, void* user,
                                   cvtflow_message* message) {
    return api::guarded(message, [&] {
        api::HostSimulation& s = api::of(simulation);
        std::function<void(const cvtflow_transition&)> call;
        if (function != nullptr)
            call = [=](const cvtflow_transition& now) {
                call_back(*simulation, "a transition", [&] { return function(simulation, &now, user); });
            };
        s.visited([&] { s.callbacks().on_transition(std::move(call)); });
    });
}

cvtflow_code cvtflow_transitions(cvtflow_simulation* simulation, cvtflow_transition* transitions, size_t* count, cvtflow_message* message) {
    return api::guarded(message, [&] {
        api::HostSimulation& s = api::of(simulation);
        s.visited([&] {
            const std::vector<cvtflow_transition>& pulled = s.callbacks().pull(count != nullptr);
            if (count == nullptr) return;
            const size_t room = std::exchange(*count, pulled.size());
            if (transitions == nullptr) return;
            if (room < pulled.size())
                throw Error(ErrorCode::argument,
                            "count: room for " + std::to_string(room) + " of " + std::to_string(pulled.size()) + " transitions");
            auto* place = reinterpret_cast<std::byte*>(transitions);
            const uint32_t size = transitions->size;  // of the caller's struct, which may be longer
            for (const cvtflow_transition& now : pulled) {
                auto* row = reinterpret_cast<cvtflow_transition*>(place);
                row->size = size;
                api::fill_versioned(row, "a transition", now);
                place += size;
            }
            s.callbacks().forget_pulled();
        });
    });
}

}  // extern "C"
