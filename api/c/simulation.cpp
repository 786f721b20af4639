#include <algorithm>
#include <cstring>
#include <utility>

#include "api/c/boundary.hpp"
#include "api/simulation_impl.hpp"

using namespace cvtflow;

namespace {

[[nodiscard]] Threads threads_of(const cvtflow_options* options) {
    if (options == nullptr || options->way == CVTFLOW_CALLER) return Threads::caller();
    if (options->way == CVTFLOW_CURRENT_ARENA) return Threads::current_arena(options->threads);
    if (options->way == CVTFLOW_PRIVATE_ARENA) return Threads::private_arena(options->threads);
    throw Error(ErrorCode::argument, "way: there is no number " + std::to_string(options->way));
}

/// Runs `action` on the simulation behind a handle; whatever it throws becomes a code and a message.
template <class Handle, class Action>
cvtflow_code act(Handle* simulation, cvtflow_message* message, Action&& action) noexcept {
    return api::guarded(message, [&] { action(api::given(simulation, "simulation").simulation); });
}

/// Answer to a question that cannot fail; `nothing` for NULL.
template <class T, class Question>
T ask(const cvtflow_simulation* simulation, T nothing, Question&& question) noexcept {
    try {
        return simulation != nullptr ? question(simulation->simulation) : nothing;
    } catch (...) {
        return nothing;
    }
}

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
    for (const std::string& line : handle.simulation.notices()) {
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
        action(handle.simulation);
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
    return api::guarded(message, [&] {
        if (options != nullptr && options->size < sizeof(cvtflow_options))
            throw Error(ErrorCode::argument, "options: its size is not set (CVTFLOW_INIT)");
        api::given(simulation, "simulation") = new cvtflow_simulation{
            Simulation(api::given(scene, "scene").scene, threads_of(options), options != nullptr ? options->segments : 0)};
    });
}

cvtflow_code cvtflow_copy(const cvtflow_simulation* from, cvtflow_simulation** copy, cvtflow_message* message) {
    return api::guarded(message, [&] { api::given(copy, "copy") = new cvtflow_simulation{api::given(from, "from").simulation.copy()}; });
}

void cvtflow_destroy(cvtflow_simulation* simulation) {
    if (simulation == nullptr || !simulation->life.give_up()) return;
    simulation->simulation.cancel();
    Visit::leave(*simulation);
}

double cvtflow_time(const cvtflow_simulation* simulation) {
    return ask(simulation, 0.0, [](const Simulation& s) { return s.time(); });
}

const char* cvtflow_method(const cvtflow_simulation* simulation) {
    return ask(simulation, "", [](const Simulation& s) { return s.method().c_str(); });
}

double cvtflow_step_length(const cvtflow_simulation* simulation) {
    return ask(simulation, 0.0, [](const Simulation& s) { return s.step_length(); });
}

cvtflow_code cvtflow_advance_to(cvtflow_simulation* simulation, double time, cvtflow_message* message) {
    return api::guarded(message, [&] { logged(api::given(simulation, "simulation"), [&](Simulation& s) { s.advance_to(time); }); });
}

cvtflow_code cvtflow_step(cvtflow_simulation* simulation, cvtflow_message* message) {
    return api::guarded(message, [&] { logged(api::given(simulation, "simulation"), [](Simulation& s) { s.step(); }); });
}

void cvtflow_cancel(cvtflow_simulation* simulation) {
    if (simulation != nullptr) simulation->simulation.cancel();
}

cvtflow_code cvtflow_largest_stable_step(cvtflow_simulation* simulation, double* step, cvtflow_message* message) {
    return act(simulation, message, [&](Simulation& s) { api::given(step, "step") = s.largest_stable_step(); });
}

cvtflow_code cvtflow_state_get(const cvtflow_simulation* simulation, void* bytes, size_t* size, cvtflow_message* message) {
    return act(simulation, message, [&](const Simulation& s) {
        const State state = s.state();
        const size_t room = std::exchange(api::given(size, "size"), state.bytes().size());
        if (bytes == nullptr) return;
        if (room < *size)
            throw Error(ErrorCode::argument, "size: " + std::to_string(room) + " bytes for a state of " + std::to_string(*size));
        std::memcpy(bytes, state.bytes().data(), *size);
    });
}

cvtflow_code cvtflow_state_set(cvtflow_simulation* simulation, const void* bytes, size_t size, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const auto* first = static_cast<const std::byte*>(bytes);
        const std::span all(&api::given(first, "bytes"), size);
        api::given(simulation, "simulation").simulation.set_state(State::from_bytes(all));
    });
}

uint64_t cvtflow_hash(const cvtflow_simulation* simulation) {
    return ask(simulation, uint64_t{0}, [](const Simulation& s) { return s.hash(); });
}

cvtflow_code cvtflow_input_set(cvtflow_simulation* simulation, int32_t input, double value, cvtflow_message* message) {
    return act(simulation, message, [&](Simulation& s) { s.set_input(static_cast<Input>(input), value); });
}

cvtflow_code cvtflow_input_get(const cvtflow_simulation* simulation, int32_t input, double* value, cvtflow_message* message) {
    return act(simulation, message, [&](const Simulation& s) { api::given(value, "value") = s.input(static_cast<Input>(input)); });
}

size_t cvtflow_size(const cvtflow_simulation* simulation) {
    return ask(simulation, size_t{0}, [](const Simulation& s) { return s.size(); });
}

const double* cvtflow_unknowns(const cvtflow_simulation* simulation) {
    return ask<const double*>(simulation, nullptr, [](const Simulation& s) { return s.unknowns().data(); });
}

cvtflow_code cvtflow_rhs(cvtflow_simulation* simulation, double time, const double* x, double* out, size_t size, cvtflow_message* message) {
    return api::guarded(message, [&] {
        const std::span from(&api::given(x, "x"), size);
        const std::span to(&api::given(out, "out"), size);
        api::given(simulation, "simulation").simulation.rhs(time, from, to);
    });
}

size_t cvtflow_channel_count(const cvtflow_simulation* simulation) {
    return ask(simulation, size_t{0}, [](const Simulation& s) { return s.channels(); });
}

cvtflow_code cvtflow_channel_describe(const cvtflow_simulation* simulation, size_t channel, cvtflow_channel_info* info,
                                      cvtflow_message* message) {
    return act(simulation, message, [&](const Simulation& s) {
        const ChannelInfo row = s.channel_info(channel);
        api::fill_versioned(info, "info", {sizeof *info, 0, row.name.data(), row.unit.data(), row.description.data(), row.width});
    });
}

cvtflow_code cvtflow_channel_find(const cvtflow_simulation* simulation, const char* name, size_t* channel, cvtflow_message* message) {
    return act(simulation, message,
               [&](const Simulation& s) { api::given(channel, "channel") = s.find_channel(&api::given(name, "name")); });
}

cvtflow_code cvtflow_channel_values(cvtflow_simulation* simulation, size_t channel, const double** values, size_t* width,
                                    cvtflow_message* message) {
    return act(simulation, message, [&](Simulation& s) {
        const std::span<const double> now = s.channel(channel);
        api::given(values, "values") = now.data();
        if (width != nullptr) *width = now.size();
    });
}

cvtflow_code cvtflow_counters_get(const cvtflow_simulation* simulation, cvtflow_counters* counters) {
    return act(simulation, nullptr, [&](const Simulation& s) {
        const Counters now = s.counters();
        api::fill_versioned(counters, "counters",
                            {sizeof *counters, 0, now.steps, now.evaluations, now.transitions, now.truncated, now.suppressed});
    });
}

cvtflow_code cvtflow_notices(const cvtflow_simulation* simulation, cvtflow_log_function function, void* user, cvtflow_message* message) {
    return api::guarded(message, [&] {
        if (function == nullptr) throw Error(ErrorCode::argument, "function is NULL");
        for (const std::string& line : api::given(simulation, "simulation").simulation.notices()) function(line.c_str(), user);
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
        const InputInfo row = input_info(static_cast<Input>(input));
        api::fill_versioned(info, "info", {sizeof *info, 0, row.name.data(), row.unit.data(), row.description.data(), 1});
    });
}

cvtflow_code cvtflow_energy_get(const cvtflow_simulation* simulation, cvtflow_energy* energy) {
    return act(simulation, nullptr, [&](const Simulation& s) {
        const Energy now = s.energy();
        api::fill_versioned(energy, "energy", {sizeof *energy, now.reliable ? 1 : 0, now.residual, now.dissipated, now.error_ratio});
    });
}

cvtflow_code cvtflow_on_output(cvtflow_simulation* simulation, double interval, cvtflow_output_function function, void* user,
                               cvtflow_message* message) {
    return act(simulation, message, [&](Simulation& s) {
        if (function == nullptr) return s.on_output(interval, {});
        s.on_output(interval, [=](Simulation&) { call_back(*simulation, "output", [&] { return function(simulation, user); }); });
    });
}

cvtflow_code cvtflow_on_transition(cvtflow_simulation* simulation, cvtflow_transition_function function, void* user,
                                   cvtflow_message* message) {
    return act(simulation, message, [&](Simulation& s) {
        if (function == nullptr) return s.on_transition({});
        s.on_transition([=](Simulation&, const Transition& t) {
            const cvtflow_transition now{sizeof now, t.pin, t.tip, t.from, t.to, 0, t.time};
            call_back(*simulation, "a transition", [&] { return function(simulation, &now, user); });
        });
    });
}

cvtflow_code cvtflow_transitions(cvtflow_simulation* simulation, cvtflow_transition* transitions, size_t* count, cvtflow_message* message) {
    return api::guarded(message, [&] {
        auto& impl = api::given(simulation, "simulation").impl();
        impl.visited([&] {
            const std::vector<Transition>& pulled = impl.callbacks().pull(count != nullptr);
            if (count == nullptr) return;
            const size_t room = std::exchange(*count, pulled.size());
            if (transitions == nullptr) return;
            if (room < pulled.size())
                throw Error(ErrorCode::argument,
                            "count: room for " + std::to_string(room) + " of " + std::to_string(pulled.size()) + " transitions");
            auto* place = reinterpret_cast<std::byte*>(transitions);
            const uint32_t size = transitions->size;  // of the caller's struct, which may be longer
            for (const Transition& t : pulled) {
                auto* row = reinterpret_cast<cvtflow_transition*>(place);
                row->size = size;
                api::fill_versioned(row, "a transition", {sizeof *row, t.pin, t.tip, t.from, t.to, 0, t.time});
                place += size;
            }
            impl.callbacks().forget_pulled();
        });
    });
}

}  // extern "C"
