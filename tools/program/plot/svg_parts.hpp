#pragma once
/// Parts of a picture as SVG: texts, marks, lines, the legend.

#include <string>
#include <vector>

#include "tools/program/plot/plot.hpp"

namespace cvtflow::tools {

inline constexpr double letter = 6.9;  ///< mean width of a character at 12 px, to leave room [px]

/// A text, escaped for the picture.
[[nodiscard]] std::string escaped(std::string text);
/// Characters of a text in UTF-8.
[[nodiscard]] double letters(const std::string& text);
/// A tenth of a pixel is enough.
[[nodiscard]] std::string px(double value);

[[nodiscard]] std::string mark_path(Mark mark, double x, double y);
[[nodiscard]] std::string mark_style(Mark mark, const std::string& colour);
[[nodiscard]] std::string line_style(const Series& series, const std::string& colour);

/// The series with the colour and the line that its number gives it, where it has none of its own.
[[nodiscard]] Series styled(const Series& series, std::size_t number);

/// Series, regions and fields that have names. `drawing` is around the origin, 24 px wide.
struct LegendEntry {
    std::string name, drawing;
};
[[nodiscard]] std::vector<LegendEntry> legend_of(const Plot& plot);

/// Where the entries are: in one column at the right of the frame, or in columns below it.
class Legend {
public:
    explicit Legend(const Plot& plot);
    [[nodiscard]] bool below() const noexcept { return below_; }
    [[nodiscard]] double width() const noexcept { return below_ ? 20.0 : width_; }                                   ///< at the right [px]
    [[nodiscard]] double height() const noexcept { return below_ ? 20.0 * static_cast<double>(rows_) + 8.0 : 0.0; }  ///< below [px]
    /// @param left, right, top of the frame   @param end of the picture without the legend [px]
    [[nodiscard]] std::string text(double left, double right, double top, double end) const;

private:
    std::vector<LegendEntry> entries_;
    bool below_ = false;
    std::size_t rows_ = 0, columns_ = 1;
    double width_ = 20.0, column_ = 0.0;
};

}  // namespace cvtflow::tools
