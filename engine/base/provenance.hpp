#pragma once
/// Provenance of numbers: program, build, machine.

#include <string>

namespace cvtflow::engine {

struct Provenance {
    std::string version;          ///< version of cvtflow, "0.2.0"
    std::string commit;           ///< `git describe --always --dirty` when the build was configured, or "unknown"
    std::string commit_date;      ///< UTC, ISO 8601; empty: unknown
    std::string compiler;         ///< "GNU 12.2.0"
    std::string build_type;       ///< "Release"
    std::string instruction_set;  ///< the widest the compiler was allowed to use: "avx512", "avx2", "avx", "sse2", "neon" or "unknown"
    std::string cpu;              ///< model of the processor, or "unknown"
    int cores = 0;                ///< usable_processors()
    std::string os;               ///< name, release and machine: "Linux 6.1.0 x86_64"
    std::string date;             ///< UTC, ISO 8601: "2024-05-01T12:34:56Z"
};

/// Provenance of this program, here and now. Unavailable values are "unknown" (cores: 1). Fails for lack of memory only.
[[nodiscard]] Provenance current_provenance();

/// Processors that the calling thread may use; at least 1.
[[nodiscard]] int usable_processors();

/// "0.2.0 (b9f2dddb)": which program made rows of a sweep, checkpoints and shared states.
[[nodiscard]] std::string version_text();

}  // namespace cvtflow::engine
