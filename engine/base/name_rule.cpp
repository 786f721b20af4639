#include "engine/base/name_rule.hpp"

#include <cstdint>

namespace cvtflow::engine {
namespace {

constexpr std::size_t longest_name = 200;  ///< [byte]; with an ending, file systems take 255

/// A character of a UTF-8 text.
struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 0;  ///< 0: no UTF-8
};

/// The first one of a text that is not empty.
Character first_of(std::string_view text) {
    const auto lead = static_cast<unsigned char>(text.front());
    const std::size_t bytes = lead < 0x80 ? 1 : lead >= 0xc2 && lead < 0xe0 ? 2 : lead >= 0xe0 && lead < 0xf0 ? 3 : lead >= 0xf0 ? 4 : 0;
    if (bytes == 0 || lead > 0xf4 || bytes > text.size()) return {};
    std::uint32_t code = bytes == 1 ? lead : lead & (0x7fU >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        const auto next = static_cast<unsigned char>(text[i]);
        if ((next & 0xc0U) != 0x80) return {};
        code = code << 6U | (next & 0x3fU);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    if (code < least[bytes] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
    return {code, bytes};
}

bool is_control(std::uint32_t code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

/// Why a character cannot be in a text that XML 1.0 holds; nullptr: it can.
const char* objection(const Character& character, bool lines) {
    if (character.bytes == 0) return "contains bytes that are not UTF-8";
    if (lines && (character.code == '\n' || character.code == '\t' || character.code == '\r')) return nullptr;
    if (is_control(character.code)) return "contains a control character";
    return character.code == 0xfffe || character.code == 0xffff ? "contains a character that is none (U+FFFE, U+FFFF)" : nullptr;
}

const char* objection_in(std::string_view text, bool lines) {
    for (std::size_t at = 0; at < text.size();) {
        const Character next = first_of(text.substr(at));
        if (const char* wrong = objection(next, lines)) return wrong;
        at += next.bytes;
    }
    return nullptr;
}

}  // namespace

std::string text_problem(std::string_view text) {
    const char* wrong = objection_in(text, true);
    return wrong != nullptr ? wrong : "";
}

std::string name_problem(std::string_view name) {
    if (name.size() > longest_name)
        return "has " + std::to_string(name.size()) + " bytes; a name has at most " + std::to_string(longest_name);
    if (name.find_first_of("/\\") != std::string_view::npos) return "contains '/' or '\\'; a name is no path";
    if (name.starts_with('.')) return "begins with a dot";
    const char* wrong = objection_in(name, false);
    return wrong != nullptr ? wrong : "";
}

std::string name_of_file(std::string_view stem) {
    std::string name;
    for (std::size_t at = 0; at < stem.size() && name.size() + 4 <= longest_name;) {
        const Character next = first_of(stem.substr(at));
        const std::size_t bytes = next.bytes == 0 ? 1 : next.bytes;
        const bool bad = objection(next, false) != nullptr || next.code == '/' || next.code == '\\' || (at == 0 && next.code == '.');
        name += bad ? "_" : stem.substr(at, bytes);
        at += bytes;
    }
    return name;
}

}  // namespace cvtflow::engine
