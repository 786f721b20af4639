#pragma once
/// Sources as the glossary sees them: their comments, literals and names.

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace cvtflow::docs {

/// Where a word can occur in a source.
enum class Place { comment, literal, name };

struct SourceText {
    Place place;
    int line;          ///< of its beginning, from 1
    std::string text;  ///< comment: its consecutive lines, without code between backticks; name: its words, in lower case
};

/// All comments and literals of C++ or C in their order, then its distinct names. Neighbours that only space separates are one text.
/// Preprocessor lines and characters are left out.
[[nodiscard]] std::vector<SourceText> texts_of(std::string_view source);

/// Text of every .cpp, .hpp, .c and .h file of the product, the laboratory and the tests, by its path from the top level.
[[nodiscard]] std::map<std::string, std::string> sources();

}  // namespace cvtflow::docs
