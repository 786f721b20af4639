/// FMI 2.0 for co-simulation.

#include <cvtflow/version.hpp>

#include "api/fmi/fmi.hpp"

using cvtflow::Error;
using cvtflow::ErrorCode;
using cvtflow::fmi::Component;
using cvtflow::fmi::guarded;
using cvtflow::fmi::Instance;
using cvtflow::fmi::not_offered;
using cvtflow::fmi::Snapshot;
using cvtflow::fmi::Stage;
using cvtflow::fmi::staged;

namespace {

using Reference = unsigned int;

struct Callbacks {
    void (*logger)(void* environment, const char* name, int status, const char* category, const char* message, ...);
    void* (*allocate)(size_t count, size_t size);
    void (*release)(void* memory);
    void (*step_finished)(void* environment, int status);
    void* environment;
};

/// "file:///a%20b/resources", "file:/a" or, on Windows, "file:///C:/a" as a path.
std::string path_of(std::string uri) {
    if (uri.starts_with("file:")) uri.erase(0, 5);
    if (uri.starts_with("//")) uri.erase(0, uri.find('/', 2));
    std::string path;
    for (std::size_t at = 0; at < uri.size(); ++at) {
        const bool escaped = uri[at] == '%' && at + 2 < uri.size();
        path += escaped ? static_cast<char>(std::stoi(uri.substr(at + 1, 2), nullptr, 16)) : uri[at];
        if (escaped) at += 2;
    }
    const bool drive = path.size() > 2 && path[0] == '/' && path[2] == ':';
    return drive ? path.substr(1) : path;
}

void log_with(Component& component, const Callbacks& callbacks) {
    component.log = [=, name = component.name](int status, const char* category, const char* message) {
        if (callbacks.logger != nullptr) callbacks.logger(callbacks.environment, name.c_str(), status, category, "%s", message);
    };
}

}  // namespace

CVTFLOW_FMI const char* fmi2GetTypesPlatform(void) { return "default"; }
CVTFLOW_FMI const char* fmi2GetVersion(void) { return "2.0"; }

CVTFLOW_FMI void* fmi2Instantiate(const char* name, int type, const char*, const char* resources, const Callbacks* callbacks, int,
                                  int logging) {
    const Callbacks calls = callbacks != nullptr ? *callbacks : Callbacks{};
    try {
        constexpr int co_simulation = 1;
        if (type != co_simulation) throw Error(ErrorCode::argument, "this FMU is for co-simulation");
        auto component = std::make_unique<Component>(
            Component{name != nullptr ? name : "", logging != 0, {}, Instance(path_of(resources)), Stage::instantiated});
        log_with(*component, calls);
        return component.release();
    } catch (const std::exception& error) {
        if (calls.logger != nullptr) calls.logger(calls.environment, name, fmi_error, "logStatusError", "%s", error.what());
        return nullptr;
    }
}

CVTFLOW_FMI void fmi2FreeInstance(void* c) { delete static_cast<Component*>(c); }

CVTFLOW_FMI int fmi2SetDebugLogging(void* c, int on, size_t, const char* const[]) {
    return guarded(c, [&](Component& self) { self.logging = on != 0; });
}

CVTFLOW_FMI int fmi2SetupExperiment(void* c, int, double, double start, int, double) {
    return staged(c, "fmi2SetupExperiment", Stage::instantiated, Stage::instantiated,
                  [&](Component& self) { self.instance.set_start(start); });
}

CVTFLOW_FMI int fmi2EnterInitializationMode(void* c) {
    return staged(c, "fmi2EnterInitializationMode", Stage::instantiated, Stage::initialising, [](Component&) {});
}

CVTFLOW_FMI int fmi2ExitInitializationMode(void* c) {
    return staged(c, "fmi2ExitInitializationMode", Stage::initialising, Stage::stepping, [](Component& self) {
        self.instance.finish_initialisation();
        for (const std::string& notice : self.instance.notices()) self.say(fmi_warning, "logStatusWarning", notice);
    });
}

CVTFLOW_FMI int fmi2Terminate(void* c) {
    return staged(c, "fmi2Terminate", Stage::stepping, Stage::terminated, [](Component& self) {
        for (const std::string& notice : self.instance.notices()) self.say(fmi_warning, "logStatusWarning", notice);
    });
}

CVTFLOW_FMI int fmi2Reset(void* c) {
    return guarded(c, [](Component& self) {
        self.instance.reset();
        self.stage = Stage::instantiated;
    });
}

CVTFLOW_FMI int fmi2GetReal(void* c, const Reference references[], size_t count, double values[]) {
    return guarded(c, [&](Component& self) {
        std::vector<double> found;
        for (size_t k = 0; k < count; ++k) self.instance.get(references[k], found);
        std::copy(found.begin(), found.end(), values);
    });
}

CVTFLOW_FMI int fmi2SetReal(void* c, const Reference references[], size_t count, const double values[]) {
    return guarded(c, [&](Component& self) {
        for (size_t k = 0; k < count; ++k) self.instance.set(references[k], values[k]);
    });
}

CVTFLOW_FMI int fmi2DoStep(void* c, double begin, double length, int) {
    return staged(c, "fmi2DoStep", Stage::stepping, Stage::stepping,
                  [&](Component& self) { static_cast<void>(self.instance.step(begin, length, {})); });
}

CVTFLOW_FMI int fmi2GetFMUstate(void* c, void** state) {
    return guarded(c, [&](Component& self) {
        auto made = std::make_unique<Snapshot>(self.instance.snapshot());
        delete static_cast<Snapshot*>(*state);
        *state = made.release();
    });
}

CVTFLOW_FMI int fmi2SetFMUstate(void* c, void* state) {
    return guarded(c, [&](Component& self) { self.restore(*static_cast<Snapshot*>(state)); });
}

CVTFLOW_FMI int fmi2FreeFMUstate(void* c, void** state) {
    return guarded(c, [&](Component&) {
        delete static_cast<Snapshot*>(*state);
        *state = nullptr;
    });
}

CVTFLOW_FMI int fmi2SerializedFMUstateSize(void* c, void* state, size_t* size) {
    return guarded(c, [&](Component&) { *size = static_cast<Snapshot*>(state)->bytes().size(); });
}

CVTFLOW_FMI int fmi2SerializeFMUstate(void* c, void* state, char bytes[], size_t size) {
    return guarded(c, [&](Component&) {
        const std::vector<std::byte> all = static_cast<Snapshot*>(state)->bytes();
        if (size < all.size()) throw Error(ErrorCode::argument, "serialise: no room for the state");
        std::copy(all.begin(), all.end(), reinterpret_cast<std::byte*>(bytes));
    });
}

CVTFLOW_FMI int fmi2DeSerializeFMUstate(void* c, const char bytes[], size_t size, void** state) {
    return guarded(c, [&](Component&) { *state = new Snapshot(Snapshot::from_bytes({reinterpret_cast<const std::byte*>(bytes), size})); });
}

CVTFLOW_FMI int fmi2GetRealStatus(void* c, int kind, double* value) {
    constexpr int last_successful_time = 2;
    if (kind != last_successful_time) return fmi_discard;
    return guarded(c, [&](Component& self) { *value = self.instance.now(); });
}

// No variable has these types, and nothing runs after a call has returned.
#define NOT_OFFERED(name, ...) \
    CVTFLOW_FMI int name(void* c, __VA_ARGS__) { return not_offered(c, #name); }
NOT_OFFERED(fmi2GetInteger, const Reference[], size_t, int[])
NOT_OFFERED(fmi2GetBoolean, const Reference[], size_t, int[])
NOT_OFFERED(fmi2GetString, const Reference[], size_t, const char*[])
NOT_OFFERED(fmi2SetInteger, const Reference[], size_t, const int[])
NOT_OFFERED(fmi2SetBoolean, const Reference[], size_t, const int[])
NOT_OFFERED(fmi2SetString, const Reference[], size_t, const char* const[])
NOT_OFFERED(fmi2GetDirectionalDerivative, const Reference[], size_t, const Reference[], size_t, const double[], double[])
NOT_OFFERED(fmi2SetRealInputDerivatives, const Reference[], size_t, const int[], const double[])
NOT_OFFERED(fmi2GetRealOutputDerivatives, const Reference[], size_t, const int[], double[])
NOT_OFFERED(fmi2GetStatus, int, int*)
NOT_OFFERED(fmi2GetIntegerStatus, int, int*)
NOT_OFFERED(fmi2GetBooleanStatus, int, int*)
NOT_OFFERED(fmi2GetStringStatus, int, const char**)
#undef NOT_OFFERED
CVTFLOW_FMI int fmi2CancelStep(void* c) { return not_offered(c, "fmi2CancelStep"); }
