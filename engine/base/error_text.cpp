#include "engine/base/error_text.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <typeinfo>
#include <variant>

namespace cvtflow::engine {
namespace {

template <class... Kinds>
[[nodiscard]] bool is_one_of(const std::exception& error) noexcept {
    return ((dynamic_cast<const Kinds*>(&error) != nullptr) || ...);
}

}  // namespace

std::string error_text(const std::exception& error) {
    if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
        const std::string path = file->path1().string();
        return (path.empty() ? "" : path + ": ") + file->code().message();
    }
    if (is_one_of<std::out_of_range, std::length_error, std::bad_optional_access, std::bad_variant_access, std::bad_cast,
                  std::bad_function_call>(error))
        return std::string("a mistake in this program, please report it (") + error.what() + ")";
    return error.what();
}

}  // namespace cvtflow::engine
