#pragma once
/// Everything that can go wrong, as one exception type with a code. The C++ interface is made of inline functions over cvtflow.h: no C++
/// type crosses the border of the library, so a host may have another compiler and another standard library.

#include <cvtflow/cvtflow.h>

#include <stdexcept>
#include <string>

namespace cvtflow {
inline namespace v0_4 {

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

class Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

    [[nodiscard]] ErrorCode code() const noexcept { return code_; }

private:
    ErrorCode code_;
};

/// "cancelled", "non_finite", …
[[nodiscard]] inline const char* error_name(ErrorCode code) noexcept { return cvtflow_code_name(static_cast<int>(code)); }

namespace detail {

/// A cvtflow_message with room for the problems of a scene, each of a line.
struct Message {
    std::uint32_t size;
    std::int32_t code;
    char text[8184];  // not cleared

    Message() noexcept : size(sizeof *this), code(0) { text[0] = '\0'; }
    [[nodiscard]] cvtflow_message* get() noexcept { return reinterpret_cast<cvtflow_message*>(this); }
    void check(cvtflow_code code_of_call) const {
        if (code_of_call != CVTFLOW_OK) throw Error(static_cast<ErrorCode>(code_of_call), text);
    }
};

/// Calls a function of C with a message behind its arguments. @throws Error
template <class Function, class... Arguments>
void call(Function* function, Arguments... arguments) {
    Message message;
    message.check(function(arguments..., message.get()));
}

/// The text that a function of C gives. @throws Error
template <class Function, class... Arguments>
[[nodiscard]] std::string text(Function* function, Arguments... arguments) {
    std::size_t size = 0;
    call(function, arguments..., static_cast<char*>(nullptr), &size);
    std::string whole(size, '\0');
    call(function, arguments..., whole.data(), &size);
    whole.resize(size - 1);
    return whole;
}

}  // namespace detail

}  // namespace v0_4
}  // namespace cvtflow
