#pragma once
/// Everything that can go wrong, as one exception type with a code. The codes are those of the C interface (cvtflow.h).

#include <stdexcept>
#include <string>

#include <cvtflow/export.hpp>

namespace cvtflow {
inline namespace v0 {

enum class ErrorCode : int {
    none = 0,
    argument = 1,      ///< a value outside its range, a length that does not fit, a name that does not exist
    scene = 2,         ///< the scene cannot be read or has problems; what() lists them all
    start_state = 3,   ///< the scene's state file cannot be read or belongs to another scene
    state = 4,         ///< a saved state belongs to another scene or version, or is damaged
    busy = 5,          ///< the simulation is being stepped: by another thread, or by the one whose callback this is
    forked = 6,        ///< the simulation ran on threads before this process was forked off; the child has none of them
    cancelled = 7,     ///< cancel() was called; the state is that of the last accepted step, and the simulation can continue
    memory = 8,        ///< no memory
    internal = 9,      ///< a defect of cvtflow
    callback = 10,     ///< C only: a callback asked to stop
    record = 11,       ///< a record, table or folder of results cannot be read or written
    non_finite = 20,   ///< the state is no longer finite: step too long, or parameters
    penetration = 21,  ///< a tip is deeper in its sheave than tip.deepest
    left_sheave = 22,  ///< a pin runs off the sheave
    max_steps = 23,    ///< run.max_steps is used up
    max_wall = 24,     ///< run.max_wall is used up
    blow_up = 25,      ///< a pin moves faster than sound in steel: step too long
    other_fault = 39,  ///< the run cannot continue for another reason, see what()
};

class CVTFLOW_EXPORT Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& message);
    Error(const Error&) = default;
    Error& operator=(const Error&) = default;
    ~Error() override;

    [[nodiscard]] ErrorCode code() const noexcept { return code_; }

private:
    ErrorCode code_;
};

/// "cancelled", "non_finite", …
[[nodiscard]] CVTFLOW_EXPORT const char* error_name(ErrorCode code) noexcept;

}  // namespace v0
}  // namespace cvtflow
