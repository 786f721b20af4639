#pragma once
/// Names and texts that come from files and go into other files, names of files, and onto terminals.

#include <string>
#include <string_view>

namespace cvtflow::engine {

/// What is wrong with the name of a scene or a sweep, which may become part of a file's name: "contains '/'" …; empty: nothing.
[[nodiscard]] std::string name_problem(std::string_view name);

/// What is wrong with a text for people, which XML 1.0 must be able to hold; line breaks and tabs are allowed. Empty: nothing.
[[nodiscard]] std::string text_problem(std::string_view text);

/// The stem of a file's name as a name: what cannot be in one becomes '_'.
[[nodiscard]] std::string name_of_file(std::string_view stem);

}  // namespace cvtflow::engine
