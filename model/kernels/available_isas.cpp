#include "model/kernels/available_isas.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "model/kernels/kernels.hpp"

namespace cvtflow::model {

namespace {

/// Whether this processor (and its system) runs what `-march=x86-64-v3` and `-v4` compile.
bool runs_here(Isa isa) {
    if (isa == Isa::baseline) return true;
#if defined(__x86_64__)
    const bool v3 =
        __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    if (isa == Isa::avx2) return v3;
    return v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#else
    return false;
#endif
}

std::string listed(const std::vector<Isa>& isas) {
    std::string list;
    for (const Isa isa : isas) list += (list.empty() ? "" : ", ") + std::string(name_of(isa));
    return list;
}

}  // namespace

std::vector<Isa> usable_isas() {
    std::vector<Isa> usable;
    for (const CompiledKernels& kernels : compiled_kernels()) {
        if (runs_here(kernels.isa)) usable.push_back(kernels.isa);
    }
    return usable;
}

Isa isa_named(std::string_view name) {
    if (name == "auto") return chosen_isa();
    const std::vector<Isa> usable = usable_isas();
    const auto found = std::find_if(usable.begin(), usable.end(), [&](Isa isa) { return name_of(isa) == name; });
    if (found != usable.end()) return *found;
    const bool known = std::find(isa_names.begin(), isa_names.end(), name) != isa_names.end();
    std::vector<Isa> contained;
    for (const CompiledKernels& kernels : compiled_kernels()) contained.push_back(kernels.isa);
    throw std::invalid_argument("instruction set \"" + std::string(name) + "\" is " + (known ? "not available here" : "unknown") +
                                " (this build has " + listed(contained) + "; this processor runs " + listed(usable) + " of them)");
}

Isa chosen_isa() {
    const char* asked = std::getenv("CVTFLOW_ISA");
    if (asked == nullptr || *asked == '\0' || std::string_view(asked) == "auto") {
        const std::vector<Isa> usable = usable_isas();
        if (!usable.empty()) return usable.back();
        throw std::invalid_argument("this program was built for processors with " + std::string(name_of(compiled_kernels().front().isa)));
    }
    return isa_named(asked);
}

}  // namespace cvtflow::model
