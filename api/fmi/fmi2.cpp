/// FMI 2.0 for co-simulation.

#include <cvtflow/version.hpp>

#include "api/fmi/fmi.hpp"

namespace fmi = cvtflow::fmi;
using cvtflow::Error;
using cvtflow::ErrorCode;
using cvtflow::api::given;
using cvtflow::fmi::Component;
using cvtflow::fmi::guarded;
using cvtflow::fmi::not_offered;
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

/// Text as the format of a logger that takes further arguments: importers that do not expand it print it as it is.
std::string format_of(std::string text) {
    for (std::size_t at = text.find('%'); at != std::string::npos; at = text.find('%', at + 2)) text.insert(at, 1, '%');
    return text;
}

void log_with(Component& component, const Callbacks& callbacks) {
    component.log = [=, name = component.name](int status, const char* category, const char* message) {
        if (callbacks.logger != nullptr)
            callbacks.logger(callbacks.environment, name.c_str(), status, category, format_of(message).c_str());
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
        auto component =
            std::make_unique<Component>(name != nullptr ? name : "", logging != 0, path_of(&given(resources, "the location of resources")));
        log_with(*component, calls);
        return component.release();
    } catch (const std::exception& error) {
        if (calls.logger != nullptr) calls.logger(calls.environment, name, fmi_error, "logStatusError", format_of(error.what()).c_str());
        return nullptr;
    }
}

CVTFLOW_FMI void fmi2FreeInstance(void* c) { fmi::free_instance(c); }

CVTFLOW_FMI int fmi2SetDebugLogging(void* c, int on, size_t count, const char* const categories[]) {
    return fmi::set_logging(c, on != 0, count, categories);
}

CVTFLOW_FMI int fmi2SetupExperiment(void* c, int, double, double start, int, double) {
    return staged(c, "fmi2SetupExperiment", Stage::instantiated, Stage::instantiated,
                  [&](Component& self) { self.instance.set_start(start); });
}

CVTFLOW_FMI int fmi2EnterInitializationMode(void* c) {
    return staged(c, "fmi2EnterInitializationMode", Stage::instantiated, Stage::initialising, [](Component&) {});
}

CVTFLOW_FMI int fmi2ExitInitializationMode(void* c) { return fmi::finish_initialisation(c); }
CVTFLOW_FMI int fmi2Terminate(void* c) { return fmi::terminate(c); }
CVTFLOW_FMI int fmi2Reset(void* c) { return fmi::reset(c); }

CVTFLOW_FMI int fmi2GetReal(void* c, const Reference references[], size_t count, double values[]) {
    return fmi::get_values(c, references, count, values, count);
}
CVTFLOW_FMI int fmi2GetBoolean(void* c, const Reference references[], size_t count, int values[]) {
    return fmi::get_flags(c, references, count, values, count);
}
CVTFLOW_FMI int fmi2SetReal(void* c, const Reference references[], size_t count, const double values[]) {
    return fmi::set_values(c, references, count, values, count);
}

CVTFLOW_FMI int fmi2DoStep(void* c, double begin, double length, int) {
    return staged(c, "fmi2DoStep", Stage::stepping, Stage::stepping,
                  [&](Component& self) { return fmi::advance(self, begin, length, {}); });
}

CVTFLOW_FMI int fmi2GetFMUstate(void* c, void** state) { return fmi::get_state(c, state); }
CVTFLOW_FMI int fmi2SetFMUstate(void* c, void* state) { return fmi::set_state(c, state); }
CVTFLOW_FMI int fmi2FreeFMUstate(void* c, void** state) { return fmi::free_state(c, state); }
CVTFLOW_FMI int fmi2SerializedFMUstateSize(void* c, void* state, size_t* size) { return fmi::state_size(c, state, size); }
CVTFLOW_FMI int fmi2SerializeFMUstate(void* c, void* state, char bytes[], size_t size) { return fmi::write_state(c, state, bytes, size); }
CVTFLOW_FMI int fmi2DeSerializeFMUstate(void* c, const char bytes[], size_t size, void** state) {
    return fmi::read_state(c, bytes, size, state);
}

CVTFLOW_FMI int fmi2GetRealStatus(void* c, int kind, double* value) {
    constexpr int last_successful_time = 2;
    if (c != nullptr && kind != last_successful_time) return fmi_discard;
    return guarded(c, [&](Component& self) { given(value, "the value") = self.instance.now(); });
}

// No variable that can be set has these types, and nothing runs after a call has returned.
#define NOT_OFFERED(name, ...) \
    CVTFLOW_FMI int name(void* c, __VA_ARGS__) { return not_offered(c, #name); }
NOT_OFFERED(fmi2GetInteger, const Reference[], size_t, int[])
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
