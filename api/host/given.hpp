#pragma once
/// Pointers of callers in C, which may be NULL. Internal to api.

#include <cstddef>
#include <cvtflow/error.hpp>
#include <span>
#include <string>

namespace cvtflow::api {

/// The object behind a pointer. @throws Error (argument) that names what is NULL
template <class T>
T& given(T* pointer, const char* name) {
    if (pointer == nullptr) throw Error(ErrorCode::argument, std::string(name) + " is NULL");
    return *pointer;
}

/// The `count` objects behind a pointer, which may be NULL if there are none. @throws Error (argument) as above
template <class T>
std::span<T> given(T* first, std::size_t count, const char* name) {
    return count == 0 ? std::span<T>() : std::span<T>(&given(first, name), count);
}

}  // namespace cvtflow::api
