#include "api/c/boundary.hpp"

using namespace cvtflow;

#define CVTFLOW_SAME(c, cpp) static_assert(static_cast<int>(c) == static_cast<int>(cpp))
CVTFLOW_SAME(CVTFLOW_ARGUMENT, ErrorCode::argument);
CVTFLOW_SAME(CVTFLOW_SCENE, ErrorCode::scene);
CVTFLOW_SAME(CVTFLOW_START_STATE, ErrorCode::start_state);
CVTFLOW_SAME(CVTFLOW_STATE, ErrorCode::state);
CVTFLOW_SAME(CVTFLOW_BUSY, ErrorCode::busy);
CVTFLOW_SAME(CVTFLOW_FORKED, ErrorCode::forked);
CVTFLOW_SAME(CVTFLOW_CANCELLED, ErrorCode::cancelled);
CVTFLOW_SAME(CVTFLOW_MEMORY, ErrorCode::memory);
CVTFLOW_SAME(CVTFLOW_INTERNAL, ErrorCode::internal);
CVTFLOW_SAME(CVTFLOW_CALLBACK, ErrorCode::callback);
CVTFLOW_SAME(CVTFLOW_RECORD, ErrorCode::record);
CVTFLOW_SAME(CVTFLOW_NON_FINITE, ErrorCode::non_finite);
CVTFLOW_SAME(CVTFLOW_PENETRATION, ErrorCode::penetration);
CVTFLOW_SAME(CVTFLOW_LEFT_SHEAVE, ErrorCode::left_sheave);
CVTFLOW_SAME(CVTFLOW_MAX_STEPS, ErrorCode::max_steps);
CVTFLOW_SAME(CVTFLOW_MAX_WALL, ErrorCode::max_wall);
CVTFLOW_SAME(CVTFLOW_BLOW_UP, ErrorCode::blow_up);
CVTFLOW_SAME(CVTFLOW_OTHER_FAULT, ErrorCode::other_fault);
CVTFLOW_SAME(CVTFLOW_CLAMPING_DRIVING, Input::clamping_driving);
CVTFLOW_SAME(CVTFLOW_CLAMPING_DRIVEN, Input::clamping_driven);
CVTFLOW_SAME(CVTFLOW_LOAD_TORQUE, Input::load_torque);
CVTFLOW_SAME(CVTFLOW_DRIVE_TORQUE, Input::drive_torque);
CVTFLOW_SAME(CVTFLOW_DRIVE_SPEED, Input::drive_speed);
CVTFLOW_SAME(CVTFLOW_RATIO, Input::ratio);
CVTFLOW_SAME(CVTFLOW_LOAD_SPEED, Input::load_speed);
CVTFLOW_SAME(CVTFLOW_LOAD_ANGLE, Input::load_angle);
CVTFLOW_SAME(CVTFLOW_DRIVE_ANGLE, Input::drive_angle);
CVTFLOW_SAME(CVTFLOW_PRESSURE_DRIVING, Input::pressure_driving);
CVTFLOW_SAME(CVTFLOW_PRESSURE_DRIVEN, Input::pressure_driven);
#undef CVTFLOW_SAME

extern "C" {

const char* cvtflow_version(void) { return CVTFLOW_VERSION_TEXT; }
const char* cvtflow_code_name(int32_t code) { return error_name(static_cast<ErrorCode>(code)); }
cvtflow_code cvtflow_shutdown(void) { return shutdown() ? CVTFLOW_OK : CVTFLOW_BUSY; }

}  // extern "C"
