#include "engine/base/provenance.hpp"

#include <sched.h>
#include <sys/utsname.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>

namespace cvtflow::engine {
namespace {

std::string instruction_set() {
#if defined(__AVX512F__)
    return "avx512";
#elif defined(__AVX2__)
    return "avx2";
#elif defined(__AVX__)
    return "avx";
#elif defined(__SSE2__)
    return "sse2";
#elif defined(__ARM_NEON)
    return "neon";
#else
    return "unknown";
#endif
}

std::string cpu_model() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const auto colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string operating_system() {
    utsname system{};
    if (uname(&system) != 0) return "unknown";
    return std::string(system.sysname) + " " + system.release + " " + system.machine;
}

std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    std::array<char, 32> text{};
    return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts)};
}

}  // namespace

Provenance current_provenance() {
    return {.version = CVTFLOW_VERSION,
            .commit = CVTFLOW_COMMIT,
            .commit_date = CVTFLOW_COMMIT_DATE,
            .compiler = CVTFLOW_COMPILER,
            .build_type = CVTFLOW_BUILD_TYPE,
            .instruction_set = instruction_set(),
            .cpu = cpu_model(),
            .cores = usable_processors(),
            .os = operating_system(),
            .date = utc_now()};
}

/// Processors of the affinity mask, which threads can use; std::thread::hardware_concurrency may be larger.
int usable_processors() {
    cpu_set_t mask;
    CPU_ZERO(&mask);
    return sched_getaffinity(0, sizeof mask, &mask) == 0 ? std::max(1, CPU_COUNT(&mask)) : 1;
}

std::string version_text() { return CVTFLOW_VERSION " (" CVTFLOW_COMMIT ")"; }

}  // namespace cvtflow::engine
