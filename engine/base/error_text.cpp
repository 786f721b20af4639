#include "engine/base/error_text.hpp"

#include <algorithm>
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

namespace {

/// Bytes of the control character that the text begins with; 0: none.
[[nodiscard]] std::size_t control_size(std::string_view text) noexcept {
    const auto first = static_cast<unsigned char>(text.front());
    if (first < 0x20 || first == 0x7f) return 1;
    return first == 0xc2 && text.size() > 1 && static_cast<unsigned char>(text[1]) < 0xa0 ? 2 : 0;
}

}  // namespace

std::string visible(std::string_view text) {
    std::string shown;
    shown.reserve(text.size());
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t size = text[at] == '\n' || text[at] == '\t' ? 0 : control_size(text.substr(at));
        for (std::size_t k = 0; k < size; ++k) {
            constexpr std::string_view digits = "0123456789abcdef";
            const auto byte = static_cast<unsigned char>(text[at + k]);
            shown += {'\\', 'x', digits[byte >> 4U], digits[byte & 15U]};
        }
        if (size == 0) shown += text[at];
        at += std::max<std::size_t>(size, 1);
    }
    return shown;
}

bool has_control(std::string_view text) noexcept {
    for (std::size_t at = 0; at < text.size(); ++at) {
        if (control_size(text.substr(at)) > 0) return true;
    }
    return false;
}

std::string error_text(const std::exception& error) {
    if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
        const std::string path = file->path1().string();
        return (path.empty() ? "" : path + ": ") + file->code().message();
    }
    if (is_one_of<std::out_of_range, std::length_error, std::bad_optional_access, std::bad_variant_access, std::bad_cast,
                  std::bad_function_call>(error))
        return std::string("an error in this program, please report it (") + error.what() + ")";
    return error.what();
}

}  // namespace cvtflow::engine
