#include "api/c/boundary.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

namespace cvtflow::api {

cvtflow_code say(cvtflow_message* message, ErrorCode code, const char* text) noexcept {
    constexpr std::size_t head = offsetof(cvtflow_message, text);
    if (message == nullptr || message->size < head) return static_cast<cvtflow_code>(code);
    message->code = static_cast<std::int32_t>(code);
    if (message->size == head) return static_cast<cvtflow_code>(code);
    const std::size_t room = std::min<std::size_t>(message->size - head, sizeof message->text) - 1;
    const std::size_t length = std::min(std::strlen(text), room);
    std::memcpy(message->text, text, length);
    message->text[length] = '\0';
    return static_cast<cvtflow_code>(code);
}

cvtflow_code say_exception(cvtflow_message* message) noexcept {
    try {
        throw;
    } catch (const Error& error) {
        return say(message, error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return say(message, ErrorCode::memory, "no memory");
    } catch (const std::exception& error) {
        return say(message, ErrorCode::internal, error.what());
    } catch (...) {
        return say(message, ErrorCode::internal, "an exception of unknown type");
    }
}

void give_text(const std::string& whole, char* text, size_t* size) {
    const size_t needed = whole.size() + 1;
    const size_t room = std::exchange(given(size, "size"), needed);
    if (text == nullptr) return;
    if (room < needed) throw Error(ErrorCode::argument, "size: " + std::to_string(room) + " bytes for a text of " + std::to_string(needed));
    std::memcpy(text, whole.c_str(), needed);
}

void fill_versioned(void* callers, const void* ours, std::size_t our_size, std::size_t first_size) {
    std::uint32_t size = 0;
    std::memcpy(&size, callers, sizeof size);
    if (size < first_size)
        throw Error(ErrorCode::argument, "size: " + std::to_string(size) + " bytes, the first version has " + std::to_string(first_size));
    constexpr std::size_t own = sizeof size;  // stays the caller's
    std::memcpy(static_cast<std::byte*>(callers) + own, static_cast<const std::byte*>(ours) + own,
                std::min<std::size_t>(size, our_size) - own);
}

}  // namespace cvtflow::api
