#pragma once
/// Version of these headers. Semantic: a program built against 0.x runs with the same 0.x, one built against 1.x with every later 1.y.
/// The library's name (libcvtflow.so.0.4) carries the major version, before 1.0 with the minor one, and so does the inline namespace of all
/// names, since they are compiled into hosts. The C interface is promised no less and no more. (tools/release writes them.)

#include <cvtflow/cvtflow.h>

#include <string>

#define CVTFLOW_VERSION_MAJOR 0
#define CVTFLOW_VERSION_MINOR 4
#define CVTFLOW_VERSION_PATCH 0

namespace cvtflow {
inline namespace v0_4 {

/// Version of the loaded library: "0.4.0".
[[nodiscard]] inline std::string library_version() { return cvtflow_version(); }

}  // namespace v0_4
}  // namespace cvtflow
