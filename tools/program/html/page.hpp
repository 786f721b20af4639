#pragma once
/// Pieces of a page, and the page around them: one document that needs nothing else.

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cvtflow::tools {

/// Numbers in base64, little-endian, as typed arrays of JavaScript take them.
[[nodiscard]] std::string packed(std::span<const float> values);
[[nodiscard]] std::string packed(std::span<const double> values);
/// Values as 16-bit integers between their least and largest: {"from", "to", "v"}.
[[nodiscard]] nlohmann::json quantised(std::span<const float> values);

struct Section {
    std::string id, title, body;  ///< body: HTML
};

struct Page {
    std::string title, lead;  ///< lead: HTML below the title
    std::vector<Section> sections;
    nlohmann::json data;               ///< for the scripts
    std::vector<std::string> scripts;  ///< names of assets, in their order
};

/// @throws std::runtime_error if a library was missing when the program was built
[[nodiscard]] std::string text_of(const Page& page);

/// Rows of two cells. @param rows heading and HTML
[[nodiscard]] std::string definition_table(const std::vector<std::pair<std::string, std::string>>& rows);

}  // namespace cvtflow::tools
