/// Functions of FMI 3.0 that this FMU does not support. Importers require all symbols.

#include "api/fmi/fmi.hpp"

using cvtflow::fmi::not_offered;

namespace {

using Reference = std::uint32_t;
using LogMessage = void (*)(void*, int, const char*, const char*);

}  // namespace

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
NO_VALUES(Boolean, bool)
NO_VALUES(String, Text)
NOT_OFFERED(fmi3GetBinary, const Reference[], size_t, size_t[], const std::uint8_t*[], size_t)
NOT_OFFERED(fmi3SetBinary, const Reference[], size_t, const size_t[], const std::uint8_t* const[], size_t)
NOT_OFFERED(fmi3GetClock, const Reference[], size_t, bool[])
NOT_OFFERED(fmi3SetClock, const Reference[], size_t, const bool[])

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
