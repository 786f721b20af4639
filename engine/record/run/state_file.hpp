#pragma once
/// States in files, each one state of engine/base/archive.hpp: settled start states, and checkpoints, which begin like one.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/archive.hpp"
#include "engine/record/run/part_file.hpp"
#include "engine/record/run/schema.hpp"

namespace cvtflow::engine {

/// What a state is of: the first fields of all states.
struct StateHead {
    std::string program{};             ///< version of the program that wrote it
    std::string method{};              ///< of the steps that led to it
    std::uint64_t scene_hash = 0;      ///< of all in the scene that the course depends on
    std::string scene{};               ///< text of the scene; empty: not known
    double step = 0.0;                 ///< step in use there; 0: not known [s]
    double balance_error_ratio = 0.0;  ///< above 1 it is wrong, and so is what begins with it
    std::vector<double> means{};       ///< of the end of a case, for the next one: see StrandEnds
    bool operator==(const StateHead&) const = default;
    void visit(Archive& archive) {
        archive("program", program), archive("method", method), archive("scene_hash", scene_hash), archive("scene", scene);
        archive("step_taken", step), archive("energy_error_ratio", balance_error_ratio), archive("means", means);
    }
};

/// What a run needs to begin there.
struct SavedState : StateHead {
    double time = 0.0;                   ///< [s]
    std::vector<double> state{};         ///< [unknowns]
    std::vector<std::uint8_t> phases{};  ///< [tips]
    bool operator==(const SavedState&) const = default;
    void visit(Archive& archive) {
        StateHead::visit(archive);
        archive("time", time), archive("state", state), archive("phases", phases);
    }
};

/// Whether a file is a state, as checkpoints are, or what a writer that was killed has left of one.
[[nodiscard]] bool is_state_file(const std::string& file);
/// Writes `saved`, a SavedState or a class like it. Readers see the former file or the new one, also after a kill or a power cut.
/// @param durable  whether it is on disk when this returns   @throws RecordError as PartFile
void write_state(const OutputFile& file, auto saved, bool durable = true) {
    const std::vector<std::byte> bytes = state_of([&](Archive& archive) { saved.visit(archive); });
    PartFile part(file);
    part.require(part.write(bytes.data(), bytes.size()));
    part.publish(durable);
}
/// The same, replacing nothing but a state.
inline void write_state(const std::string& path, const auto& saved) { write_state(OutputFile(path, is_state_file), saved); }

/// Gives the fields of a state file to visit(archive), which may read the first ones only.
/// @param kind  name of what has these fields   @throws RecordError "PATH: reason": missing, no state, of another version or kind, damaged
void read_state_file(const std::string& path, std::string_view kind, const std::function<void(Archive&)>& visit);
/// A state to begin with: a settled one, a checkpoint, or the last one of a record. @throws RecordError as above
[[nodiscard]] SavedState read_state(const std::string& path);
/// The last state of a record. @throws RecordError as RunReader, and where it has none
[[nodiscard]] SavedState last_state_of_record(const std::string& path);

}  // namespace cvtflow::engine
