/// FMI 3.0 for co-simulation. Functions that this FMU does not support are at the end, because importers require all symbols.

#include "api/fmi/fmi.hpp"

namespace fmi = cvtflow::fmi;
using cvtflow::api::given;
using cvtflow::fmi::Component;
using cvtflow::fmi::guarded;
using cvtflow::fmi::Intermediate;
using cvtflow::fmi::not_offered;
using cvtflow::fmi::Stage;
using cvtflow::fmi::staged;

namespace {

using Reference = std::uint32_t;
using LogMessage = void (*)(void* environment, int status, const char* category, const char* message);
using IntermediateUpdate = void (*)(void* environment, double time, bool set_requested, bool get_allowed, bool step_finished,
                                    bool can_return_early, bool* early_return_requested, double* early_return_time);

/// The importer's side of intermediate updates.
struct Component3 final : Component {
    using Component::Component;
    IntermediateUpdate update = nullptr;
    void* environment = nullptr;
    bool early_return = false;

    [[nodiscard]] Intermediate intermediate() {
        if (update == nullptr) return {};
        return [this](double time) {
            bool requested = false;
            double when = time;
            stage = Stage::in_step;
            update(environment, time, false, true, true, early_return, &requested, &when);
            stage = Stage::stepping;
            return freed || (requested && early_return && when <= time);
        };
    }
};

}  // namespace

CVTFLOW_FMI const char* fmi3GetVersion(void) { return "3.0"; }

CVTFLOW_FMI void* fmi3InstantiateCoSimulation(const char* name, const char*, const char* resources, bool, bool logging, bool,
                                              bool early_return, const Reference[], size_t, void* environment, LogMessage log,
                                              IntermediateUpdate update) {
    const auto say = [=](int status, const char* category, const char* message) {
        if (log != nullptr) log(environment, status, category, message);
    };
    try {
        std::string folder = &given(resources, "the path of resources");
        while (folder.ends_with('/') || folder.ends_with('\\')) folder.pop_back();
        auto component = std::make_unique<Component3>(name != nullptr ? name : "", logging, folder);
        component->log = say;
        component->update = update;
        component->environment = environment;
        component->early_return = early_return;
        return static_cast<Component*>(component.release());
    } catch (const std::exception& error) {
        say(fmi_error, "logStatusError", error.what());
        return nullptr;
    }
}

CVTFLOW_FMI void fmi3FreeInstance(void* c) { fmi::free_instance(c); }

CVTFLOW_FMI int fmi3SetDebugLogging(void* c, bool on, size_t count, const char* const categories[]) {
    return fmi::set_logging(c, on, count, categories);
}

CVTFLOW_FMI int fmi3EnterInitializationMode(void* c, bool, double, double start, bool, double) {
    return staged(c, "fmi3EnterInitializationMode", Stage::instantiated, Stage::initialising,
                  [&](Component& self) { self.instance.set_start(start); });
}

CVTFLOW_FMI int fmi3ExitInitializationMode(void* c) { return fmi::finish_initialisation(c); }
CVTFLOW_FMI int fmi3Terminate(void* c) { return fmi::terminate(c); }
CVTFLOW_FMI int fmi3Reset(void* c) { return fmi::reset(c); }

CVTFLOW_FMI int fmi3GetFloat64(void* c, const Reference references[], size_t count, double values[], size_t room) {
    return fmi::get_values(c, references, count, values, room);
}
CVTFLOW_FMI int fmi3GetBoolean(void* c, const Reference references[], size_t count, bool values[], size_t room) {
    return fmi::get_flags(c, references, count, values, room);
}
CVTFLOW_FMI int fmi3SetFloat64(void* c, const Reference references[], size_t count, const double values[], size_t number) {
    return fmi::set_values(c, references, count, values, number);
}

CVTFLOW_FMI int fmi3DoStep(void* c, double begin, double length, bool, bool* event, bool* terminate, bool* early, double* reached) {
    const int status = staged(c, "fmi3DoStep", Stage::stepping, Stage::stepping, [&](Component& self) {
        given(event, "eventHandlingNeeded") = given(terminate, "terminateSimulation") = given(early, "earlyReturn") = false;
        given(reached, "lastSuccessfulTime") = self.instance.now();
        const int outcome = fmi::advance(self, begin, length, static_cast<Component3&>(self).intermediate());
        *reached = self.instance.now();
        *early = *reached < begin + length;
        return outcome;
    });
    if (c != nullptr && static_cast<Component*>(c)->freed) fmi::free_instance(c);
    return status;
}

CVTFLOW_FMI int fmi3GetFMUState(void* c, void** state) { return fmi::get_state(c, state); }
CVTFLOW_FMI int fmi3SetFMUState(void* c, void* state) { return fmi::set_state(c, state); }
CVTFLOW_FMI int fmi3FreeFMUState(void* c, void** state) { return fmi::free_state(c, state); }
CVTFLOW_FMI int fmi3SerializedFMUStateSize(void* c, void* state, size_t* size) { return fmi::state_size(c, state, size); }
CVTFLOW_FMI int fmi3SerializeFMUState(void* c, void* state, std::uint8_t bytes[], size_t size) {
    return fmi::write_state(c, state, bytes, size);
}
CVTFLOW_FMI int fmi3DeserializeFMUState(void* c, const std::uint8_t bytes[], size_t size, void** state) {
    return fmi::read_state(c, bytes, size, state);
}

CVTFLOW_FMI int fmi3GetNumberOfVariableDependencies(void* c, Reference, size_t* number) {
    return guarded(c, [&](Component&) { given(number, "the number of dependencies") = 0; });
}

// Functions that this FMU does not support.

CVTFLOW_FMI void* fmi3InstantiateModelExchange(const char*, const char*, const char*, bool, bool, void* environment, LogMessage log) {
    if (log != nullptr) log(environment, fmi_error, "logStatusError", "this FMU is for co-simulation");
    return nullptr;
}

CVTFLOW_FMI void* fmi3InstantiateScheduledExecution(const char*, const char*, const char*, bool, bool, void* environment, LogMessage log,
                                                    void (*)(void*), void (*)(void), void (*)(void)) {
    if (log != nullptr) log(environment, fmi_error, "logStatusError", "this FMU is for co-simulation");
    return nullptr;
}

#define NOT_OFFERED(name, ...) \
    CVTFLOW_FMI int name(void* c __VA_OPT__(, ) __VA_ARGS__) { return not_offered(c, #name); }
#define NO_VALUES(name, type)                                                                                                     \
    CVTFLOW_FMI int fmi3Get##name(void* c, const Reference[], size_t, type[], size_t) { return not_offered(c, "fmi3Get" #name); } \
    CVTFLOW_FMI int fmi3Set##name(void* c, const Reference[], size_t, const type[], size_t) { return not_offered(c, "fmi3Set" #name); }

// No variable has these types.
using Text = const char*;
NO_VALUES(Float32, float)
NO_VALUES(Int8, std::int8_t)
NO_VALUES(UInt8, std::uint8_t)
NO_VALUES(Int16, std::int16_t)
NO_VALUES(UInt16, std::uint16_t)
NO_VALUES(Int32, std::int32_t)
NO_VALUES(UInt32, std::uint32_t)
NO_VALUES(Int64, std::int64_t)
NO_VALUES(UInt64, std::uint64_t)
NO_VALUES(String, Text)
NOT_OFFERED(fmi3GetBinary, const Reference[], size_t, size_t[], const std::uint8_t*[], size_t)
NOT_OFFERED(fmi3SetBinary, const Reference[], size_t, const size_t[], const std::uint8_t* const[], size_t)
NOT_OFFERED(fmi3GetClock, const Reference[], size_t, bool[])
NOT_OFFERED(fmi3SetClock, const Reference[], size_t, const bool[])

NOT_OFFERED(fmi3SetBoolean, const Reference[], size_t, const bool[], size_t)

// Derivatives.
NOT_OFFERED(fmi3GetVariableDependencies, Reference, size_t[], Reference[], size_t[], int[], size_t)
NOT_OFFERED(fmi3GetDirectionalDerivative, const Reference[], size_t, const Reference[], size_t, const double[], size_t, double[], size_t)
NOT_OFFERED(fmi3GetAdjointDerivative, const Reference[], size_t, const Reference[], size_t, const double[], size_t, double[], size_t)
NOT_OFFERED(fmi3GetOutputDerivatives, const Reference[], size_t, const std::int32_t[], double[], size_t)

// Events, clocks, structural parameters.
NOT_OFFERED(fmi3EnterEventMode)
NOT_OFFERED(fmi3EnterStepMode)
NOT_OFFERED(fmi3EnterConfigurationMode)
NOT_OFFERED(fmi3ExitConfigurationMode)
NOT_OFFERED(fmi3GetIntervalDecimal, const Reference[], size_t, double[], int[])
NOT_OFFERED(fmi3GetIntervalFraction, const Reference[], size_t, std::uint64_t[], std::uint64_t[], int[])
NOT_OFFERED(fmi3GetShiftDecimal, const Reference[], size_t, double[])
NOT_OFFERED(fmi3GetShiftFraction, const Reference[], size_t, std::uint64_t[], std::uint64_t[])
NOT_OFFERED(fmi3SetIntervalDecimal, const Reference[], size_t, const double[])
NOT_OFFERED(fmi3SetIntervalFraction, const Reference[], size_t, const std::uint64_t[], const std::uint64_t[])
NOT_OFFERED(fmi3SetShiftDecimal, const Reference[], size_t, const double[])
NOT_OFFERED(fmi3SetShiftFraction, const Reference[], size_t, const std::uint64_t[], const std::uint64_t[])
NOT_OFFERED(fmi3EvaluateDiscreteStates)
NOT_OFFERED(fmi3UpdateDiscreteStates, bool*, bool*, bool*, bool*, bool*, double*)
NOT_OFFERED(fmi3ActivateModelPartition, Reference, double)

// Model exchange.
NOT_OFFERED(fmi3EnterContinuousTimeMode)
NOT_OFFERED(fmi3CompletedIntegratorStep, bool, bool*, bool*)
NOT_OFFERED(fmi3SetTime, double)
NOT_OFFERED(fmi3SetContinuousStates, const double[], size_t)
NOT_OFFERED(fmi3GetContinuousStateDerivatives, double[], size_t)
NOT_OFFERED(fmi3GetEventIndicators, double[], size_t)
NOT_OFFERED(fmi3GetContinuousStates, double[], size_t)
NOT_OFFERED(fmi3GetNominalsOfContinuousStates, double[], size_t)
NOT_OFFERED(fmi3GetNumberOfEventIndicators, size_t*)
NOT_OFFERED(fmi3GetNumberOfContinuousStates, size_t*)
