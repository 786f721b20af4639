#include "api/fmi/fmi.hpp"

#include <algorithm>
#include <utility>

namespace cvtflow::fmi {

using api::given;

namespace {

void check_room(std::size_t variables, std::size_t values) {
    if (variables != values)
        throw Error(ErrorCode::argument, std::to_string(values) + " values for variables of " + std::to_string(variables));
}

[[nodiscard]] const Snapshot& snapshot_behind(const void* state) { return given(static_cast<const Snapshot*>(state), "the state"); }

/// Writes them to the log.
void say_notices(Component& self) {
    for (const std::string& notice : self.instance.notices()) self.say(fmi_warning, "logStatusWarning", notice);
}

}  // namespace

void free_instance(void* component) noexcept {
    auto* self = static_cast<Component*>(component);
    if (self != nullptr && self->stage == Stage::in_step)
        self->freed = true;
    else
        delete self;
}

int advance(Component& self, double begin, double length, const Intermediate& intermediate) {
    const bool was_unreliable = self.instance.unreliable();
    self.instance.step(begin, length, intermediate);
    if (was_unreliable || !self.instance.unreliable()) return fmi_ok;
    say_notices(self);
    return fmi_warning;
}

int finish_initialisation(void* component) noexcept {
    return staged(component, "ExitInitializationMode", Stage::initialising, Stage::stepping, [](Component& self) {
        self.instance.finish_initialisation();
        say_notices(self);
        return self.instance.unreliable() ? fmi_warning : fmi_ok;
    });
}

int terminate(void* component) noexcept { return staged(component, "Terminate", Stage::stepping, Stage::terminated, say_notices); }

int reset(void* component) noexcept {
    return between_steps(component, "Reset", [](Component& self) {
        self.instance.reset();
        self.stage = Stage::instantiated;
    });
}

int get_values(void* component, const std::uint32_t* references, std::size_t count, double* values, std::size_t room) noexcept {
    return guarded(component, [&](Component& self) {
        const std::span<double> to = given(values, room, "values");
        self.found.clear();
        for (const std::uint32_t reference : given(references, count, "value references")) self.instance.get(reference, self.found);
        check_room(self.found.size(), room);
        std::copy(self.found.begin(), self.found.end(), to.begin());
    });
}

template <class Flag>
int get_flags(void* component, const std::uint32_t* references, std::size_t count, Flag* values, std::size_t room) noexcept {
    return guarded(component, [&](Component& self) {
        check_room(count, room);
        const std::span<Flag> to = given(values, room, "values");
        const std::span<const std::uint32_t> from = given(references, count, "value references");
        std::transform(from.begin(), from.end(), to.begin(), [&](std::uint32_t reference) { return self.instance.flag(reference); });
    });
}
template int get_flags(void*, const std::uint32_t*, std::size_t, int*, std::size_t) noexcept;
template int get_flags(void*, const std::uint32_t*, std::size_t, bool*, std::size_t) noexcept;

int set_values(void* component, const std::uint32_t* references, std::size_t count, const double* values, std::size_t number) noexcept {
    return guarded(component, [&](Component& self) {
        check_room(count, number);  // whatever may be set is one number
        const std::span<const double> from = given(values, count, "values");
        const std::span<const std::uint32_t> to = given(references, count, "value references");
        for (std::size_t k = 0; k < count; ++k) self.instance.set(to[k], from[k]);
    });
}

int get_state(void* component, void** state) noexcept {
    return between_steps(component, "GetFMUState", [&](Component& self) {
        void*& kept = given(state, "the state");
        auto made = std::make_unique<Snapshot>(self.instance.snapshot());
        delete static_cast<Snapshot*>(kept);
        kept = made.release();
    });
}

int set_state(void* component, const void* state) noexcept {
    return between_steps(component, "SetFMUState", [&](Component& self) { self.restore(snapshot_behind(state)); });
}

int free_state(void* component, void** state) noexcept {
    return guarded(component, [&](Component&) { delete static_cast<Snapshot*>(std::exchange(given(state, "the state"), nullptr)); });
}

int state_size(void* component, const void* state, std::size_t* size) noexcept {
    return guarded(component, [&](Component&) { given(size, "the size") = snapshot_behind(state).bytes().size(); });
}

int write_state(void* component, const void* state, void* bytes, std::size_t size) noexcept {
    return guarded(component, [&](Component&) {
        const std::vector<std::byte> all = snapshot_behind(state).bytes();
        if (size < all.size()) throw Error(ErrorCode::argument, "serialise: no room for the state");
        std::copy(all.begin(), all.end(), given(static_cast<std::byte*>(bytes), size, "serialized state").begin());
    });
}

int read_state(void* component, const void* bytes, std::size_t size, void** state) noexcept {
    return guarded(component, [&](Component&) {
        void*& made = given(state, "the state");
        made = new Snapshot(Snapshot::from_bytes(given(static_cast<const std::byte*>(bytes), size, "serialized state")));
    });
}

int set_logging(void* component, bool on, std::size_t count, const char* const* categories) noexcept {
    return guarded(component, [&](Component& self) {
        static_cast<void>(given(categories, count, "categories"));  // all are logged
        self.logging = on;
    });
}

int not_offered(void* component, const char* function) noexcept {
    return guarded(component, [&](Component&) {
        throw Error(ErrorCode::argument, std::string(function) + ": this FMU does not support it (see its description)");
    });
}

}  // namespace cvtflow::fmi
