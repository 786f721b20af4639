#pragma once
/// One state in a small HDF5 file: settled start states and checkpoints.
///
///     /          attributes: format "cvtflow state", format_version, time [s], fingerprint, and those given
///     /y         [size] float64
///     /phases    [count] uint8
///     /more/<name>  [size] float64: whatever else belongs to the state; absent if there is nothing
///
/// and the seal behind it (file_seal.hpp): a state is what was saved, or refused.

#include <cstdint>
#include <string>
#include <vector>

#include "engine/record/run/part_file.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

/// Named numbers that belong to a state.
struct NamedArray {
    std::string name;
    std::vector<double> values{};  ///< [numbers of the field]
    bool operator==(const NamedArray&) const = default;
};

struct SavedState {
    double time = 0.0;            ///< [s]
    std::vector<double> state{};  ///< [unknowns]
    std::vector<std::uint8_t> phases{};
    std::string fingerprint{};  ///< hash of everything that defines the numbers (parameters, layout); compared when a run resumes
    std::vector<Attribute> attributes{};
    std::vector<NamedArray> more{};  ///< sorted by name after reading
    bool operator==(const SavedState&) const = default;
};

/// Writes the file atomically: readers see the former file or the new one, also after a kill or a power cut. Written to
/// `<path>.part`, synced, renamed. Throws RecordError: missing folder, not writable, disk full, another process writing the same file.
/// @param durable  whether it is on disk when this returns
void write_state(const OutputFile& file, const SavedState& saved, bool durable = true);
/// The same, replacing nothing but a state.
void write_state(const std::string& path, const SavedState& saved);

/// Whether a file is a state, as checkpoints are, or what a writer that was killed has left of one.
[[nodiscard]] bool is_state_file(const std::string& file);

/// Reads a state bit for bit as it was written, with attributes sorted by name. Throws RecordError: missing, not HDF5, truncated, damaged
/// (no seal, or a broken one), another kind.
[[nodiscard]] SavedState read_state(const std::string& path);

}  // namespace cvtflow::engine
