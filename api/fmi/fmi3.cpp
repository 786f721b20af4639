/// FMI 3.0 for co-simulation.

#include "api/fmi/fmi.hpp"

using cvtflow::Error;
using cvtflow::ErrorCode;
using cvtflow::fmi::Component;
using cvtflow::fmi::guarded;
using cvtflow::fmi::Instance;
using cvtflow::fmi::Intermediate;
using cvtflow::fmi::Snapshot;
using cvtflow::fmi::Stage;
using cvtflow::fmi::staged;

namespace {

using Reference = std::uint32_t;
using LogMessage = void (*)(void* environment, int status, const char* category, const char* message);
using IntermediateUpdate = void (*)(void* environment, double time, bool set_requested, bool get_allowed, bool step_finished,
                                    bool can_return_early, bool* early_return_requested, double* early_return_time);

/// The importer's side of intermediate updates.
struct Component3 : Component {
    IntermediateUpdate update = nullptr;
    void* environment = nullptr;
    bool early_return = false;

    [[nodiscard]] Intermediate intermediate() const {
        if (update == nullptr) return {};
        return [this](double time) {
            bool requested = false;
            double when = time;
            update(environment, time, false, true, true, early_return, &requested, &when);
            return requested && early_return && when <= time;
        };
    }
};

void check_room(std::size_t wanted, std::size_t given) {
    if (wanted != given) throw Error(ErrorCode::argument, std::to_string(given) + " values for variables of " + std::to_string(wanted));
}

}  // namespace

CVTFLOW_FMI const char* fmi3GetVersion(void) { return "3.0"; }

CVTFLOW_FMI void* fmi3InstantiateCoSimulation(const char* name, const char*, const char* resources, bool, bool logging, bool,
                                              bool early_return, const Reference[], size_t, void* environment, LogMessage log,
                                              IntermediateUpdate update) {
    const auto say = [=](int status, const char* category, const char* message) {
        if (log != nullptr) log(environment, status, category, message);
    };
    try {
        std::string folder = resources != nullptr ? resources : "";
        while (folder.ends_with('/') || folder.ends_with('\\')) folder.pop_back();
        auto component = std::make_unique<Component3>(Component3{
            {name != nullptr ? name : "", logging, say, Instance(folder), Stage::instantiated}, update, environment, early_return});
        return static_cast<Component*>(component.release());
    } catch (const std::exception& error) {
        say(fmi_error, "logStatusError", error.what());
        return nullptr;
    }
}

CVTFLOW_FMI void fmi3FreeInstance(void* c) { delete static_cast<Component3*>(static_cast<Component*>(c)); }

CVTFLOW_FMI int fmi3SetDebugLogging(void* c, bool on, size_t, const char* const[]) {
    return guarded(c, [&](Component& self) { self.logging = on; });
}

CVTFLOW_FMI int fmi3EnterInitializationMode(void* c, bool, double, double start, bool, double) {
    return staged(c, "fmi3EnterInitializationMode", Stage::instantiated, Stage::initialising,
                  [&](Component& self) { self.instance.set_start(start); });
}

CVTFLOW_FMI int fmi3ExitInitializationMode(void* c) {
    return staged(c, "fmi3ExitInitializationMode", Stage::initialising, Stage::stepping, [](Component& self) {
        self.instance.finish_initialisation();
        for (const std::string& notice : self.instance.notices()) self.say(fmi_warning, "logStatusWarning", notice);
    });
}

CVTFLOW_FMI int fmi3Terminate(void* c) {
    return staged(c, "fmi3Terminate", Stage::stepping, Stage::terminated, [](Component& self) {
        for (const std::string& notice : self.instance.notices()) self.say(fmi_warning, "logStatusWarning", notice);
    });
}

CVTFLOW_FMI int fmi3Reset(void* c) {
    return guarded(c, [](Component& self) {
        self.instance.reset();
        self.stage = Stage::instantiated;
    });
}

CVTFLOW_FMI int fmi3GetFloat64(void* c, const Reference references[], size_t count, double values[], size_t room) {
    return guarded(c, [&](Component& self) {
        std::vector<double> found;
        for (size_t k = 0; k < count; ++k) self.instance.get(references[k], found);
        check_room(found.size(), room);
        std::copy(found.begin(), found.end(), values);
    });
}

CVTFLOW_FMI int fmi3SetFloat64(void* c, const Reference references[], size_t count, const double values[], size_t given) {
    return guarded(c, [&](Component& self) {
        check_room(count, given);  // whatever may be set is one number
        for (size_t k = 0; k < count; ++k) self.instance.set(references[k], values[k]);
    });
}

CVTFLOW_FMI int fmi3DoStep(void* c, double begin, double length, bool, bool* event, bool* terminate, bool* early, double* reached) {
    *event = *terminate = *early = false;
    return staged(c, "fmi3DoStep", Stage::stepping, Stage::stepping, [&](Component& self) {
        *reached = self.instance.now();
        *reached = self.instance.step(begin, length, static_cast<Component3&>(self).intermediate());
        *early = *reached < begin + length;
    });
}

CVTFLOW_FMI int fmi3GetFMUState(void* c, void** state) {
    return guarded(c, [&](Component& self) {
        auto made = std::make_unique<Snapshot>(self.instance.snapshot());
        delete static_cast<Snapshot*>(*state);
        *state = made.release();
    });
}

CVTFLOW_FMI int fmi3SetFMUState(void* c, void* state) {
    return guarded(c, [&](Component& self) { self.restore(*static_cast<Snapshot*>(state)); });
}

CVTFLOW_FMI int fmi3FreeFMUState(void* c, void** state) {
    return guarded(c, [&](Component&) {
        delete static_cast<Snapshot*>(*state);
        *state = nullptr;
    });
}

CVTFLOW_FMI int fmi3SerializedFMUStateSize(void* c, void* state, size_t* size) {
    return guarded(c, [&](Component&) { *size = static_cast<Snapshot*>(state)->bytes().size(); });
}

CVTFLOW_FMI int fmi3SerializeFMUState(void* c, void* state, std::uint8_t bytes[], size_t size) {
    return guarded(c, [&](Component&) {
        const std::vector<std::byte> all = static_cast<Snapshot*>(state)->bytes();
        check_room(all.size(), size);
        std::copy(all.begin(), all.end(), reinterpret_cast<std::byte*>(bytes));
    });
}

CVTFLOW_FMI int fmi3DeserializeFMUState(void* c, const std::uint8_t bytes[], size_t size, void** state) {
    return guarded(c, [&](Component&) { *state = new Snapshot(Snapshot::from_bytes({reinterpret_cast<const std::byte*>(bytes), size})); });
}

CVTFLOW_FMI int fmi3GetNumberOfVariableDependencies(void* c, Reference, size_t* number) {
    return guarded(c, [&](Component&) { *number = 0; });
}
