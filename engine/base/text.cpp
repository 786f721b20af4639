#include "engine/base/text.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cstdint>
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
        for (std::size_t k = 0; k < size; ++k) shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[at + k]));
        if (size == 0) shown += text[at];
        at += std::max<std::size_t>(size, 1);
    }
    return shown;
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

/// Reason why a character cannot be in a text of XML 1.0; empty: it can.
std::string objection(const Character& character, bool lines) {
    if (character.bytes == 0) return "contains bytes that are not UTF-8";
    if (lines && (character.code == '\n' || character.code == '\t' || character.code == '\r')) return "";
    if (is_control(character.code)) return "contains a control character";
    return character.code == 0xfffe || character.code == 0xffff ? "contains a noncharacter (U+FFFE, U+FFFF)" : "";
}

std::string objection_in(std::string_view text, bool lines) {
    for (std::size_t at = 0; at < text.size();) {
        const Character next = first_of(text.substr(at));
        if (std::string wrong = objection(next, lines); !wrong.empty()) return wrong;
        at += next.bytes;
    }
    return "";
}

}  // namespace

std::string text_problem(std::string_view text) { return objection_in(text, true); }

std::string name_problem(std::string_view name) {
    if (name.size() > longest_name)
        return "has " + std::to_string(name.size()) + " bytes; a name has at most " + std::to_string(longest_name);
    if (name.find_first_of("/\\") != std::string_view::npos) return "contains '/' or '\\'; a name is no path";
    if (name.starts_with('.')) return "begins with a dot";
    return objection_in(name, false);
}

std::string name_of_file(std::string_view stem) {
    std::string name;
    for (std::size_t at = 0; at < stem.size() && name.size() + 4 <= longest_name;) {
        const Character next = first_of(stem.substr(at));
        const std::size_t bytes = next.bytes == 0 ? 1 : next.bytes;
        const bool bad = !objection(next, false).empty() || next.code == '/' || next.code == '\\' || (at == 0 && next.code == '.');
        name += bad ? "_" : stem.substr(at, bytes);
        at += bytes;
    }
    return name;
}

std::vector<std::string> words_of(std::string_view text) {
    std::vector<std::string> words;
    for (std::size_t begin = 0; (begin = text.find_first_not_of(' ', begin)) != std::string_view::npos;) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        words.emplace_back(text.substr(begin, end - begin));
        begin = end;
    }
    return words;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> two_back(b.size() + 1);
    std::vector<std::size_t> back(b.size() + 1);
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        two_back.swap(back);
        back.swap(row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({back[j] + 1, row[j - 1] + 1, back[j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
            const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swapped) row[j] = std::min(row[j], two_back[j - 2] + 1);
        }
    }
    return row[b.size()];
}

std::string closest(std::string_view word, const std::vector<std::string>& candidates) {
    if (word.size() > 100) return {};  // no slip of the fingers, and a megabyte would take seconds
    std::size_t best = std::max<std::size_t>(2, word.size() / 3) + 1;
    std::string found;
    for (const auto& candidate : candidates) {
        const std::size_t distance = edit_distance(word, candidate);
        if (distance >= best || distance >= std::max(word.size(), candidate.size())) continue;
        best = distance;
        found = candidate;
    }
    return found;
}

std::string did_you_mean(const std::string& suggestion) {
    return did_you_mean(suggestion.empty() ? std::vector<std::string>{} : std::vector{suggestion});
}

std::string did_you_mean(const std::vector<std::string>& suggestions) {
    return suggestions.empty() ? std::string{} : fmt::format(" (did you mean \"{}\"?)", fmt::join(suggestions, "\" or \""));
}

}  // namespace cvtflow::engine
