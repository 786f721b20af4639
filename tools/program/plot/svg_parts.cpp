#include "tools/program/plot/svg_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/program/plot/field.hpp"
#include "tools/program/text/markup.hpp"

namespace cvtflow::tools {

std::string escaped(std::string text) {
    std::erase_if(text, [](char c) { return static_cast<unsigned char>(c) < 0x20; });  // XML knows no control characters
    return html(text);
}

double letters(const std::string& text) {
    return static_cast<double>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string px(double value) {
    std::string text = fmt::format("{:.1f}", value);
    if (text.ends_with(".0")) text.erase(text.size() - 2);
    return text == "-0" ? "0" : text;
}

std::string mark_path(Mark mark, double x, double y) {
    switch (mark) {
        case Mark::none: return "";
        case Mark::dot:
        case Mark::small_dot: return fmt::format("M{} {}h0", px(x), px(y));  // a round cap draws it
        case Mark::ring: return fmt::format("M{} {}a3.5 3.5 0 1 0 7 0a3.5 3.5 0 1 0 -7 0", px(x - 3.5), px(y));
        case Mark::square: return fmt::format("M{} {}h6v6h-6z", px(x - 3.0), px(y - 3.0));
        case Mark::diamond: return fmt::format("M{} {}l4 4l-4 4l-4 -4z", px(x), px(y - 4.0));
        case Mark::triangle: return fmt::format("M{} {}l4 7h-8z", px(x), px(y - 4.5));
        case Mark::cross: return fmt::format("M{} {}l6 6m0 -6l-6 6", px(x - 3.0), px(y - 3.0));
    }
    return "";
}

std::string mark_style(Mark mark, const std::string& colour) {
    if (mark == Mark::dot || mark == Mark::small_dot)
        return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\"", colour, mark == Mark::dot ? 6 : 3.5);
    const bool open = mark == Mark::ring || mark == Mark::cross;
    return fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1.4\"", open ? "none" : colour, colour);
}

std::string line_style(const Series& series, const std::string& colour) {
    return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{}", colour, px(series.width),
                       series.line == Line::dashed   ? " stroke-dasharray=\"6 4\""
                       : series.line == Line::dotted ? " stroke-dasharray=\"2 3\""
                                                     : "");
}

Series styled(const Series& series, std::size_t number) {
    Series with = series;
    if (!with.colour.empty()) return with;
    with.colour = palette(number);
    if (with.line == Line::solid) with.line = palette_line(number);
    return with;
}

std::vector<LegendEntry> legend_of(const Plot& plot) {
    std::vector<LegendEntry> entries;
    for (std::size_t k = 0; k < plot.series.size(); ++k) {
        const Series series = styled(plot.series[k], k);
        if (series.name.empty()) continue;
        std::string drawing;
        if (series.line != Line::none) drawing += fmt::format("<path d=\"M-12 0h24\" {}/>", line_style(series, escaped(series.colour)));
        if (series.mark != Mark::none)
            drawing +=
                fmt::format("<path d=\"{}\" {}/>", mark_path(series.mark, 0.0, 0.0), mark_style(series.mark, escaped(series.colour)));
        entries.push_back({series.name, drawing});
    }
    for (const Region& region : plot.regions) {
        if (!region.name.empty())
            entries.push_back(
                {region.name, fmt::format("<rect x=\"-12\" y=\"-6\" width=\"24\" height=\"12\" fill=\"{}\"/>", escaped(region.colour))});
    }
    for (const Field& field : plot.fields) {
        entries.push_back({field.label, ""});
        for (const auto& [name, colour] : field_legend(field))
            entries.push_back({name, fmt::format("<rect x=\"-12\" y=\"-10\" width=\"24\" height=\"20\" fill=\"{}\"/>", colour)});
    }
    return entries;
}

Legend::Legend(const Plot& plot) : entries_(legend_of(plot)) {
    if (entries_.empty()) return;
    double names = 0.0;
    for (const LegendEntry& entry : entries_) names = std::max(names, letters(entry.name));
    width_ = 56.0 + letter * names;
    below_ = width_ > plot.width / 3.0 && plot.fields.empty();
    column_ = 44.0 + letter * names;
    columns_ = std::max<std::size_t>(1, static_cast<std::size_t>((plot.width - 40.0) / column_));
    rows_ = (entries_.size() + columns_ - 1) / columns_;
}

std::string Legend::text(double left, double right, double top, double end) const {
    std::string made;
    for (std::size_t k = 0; k < entries_.size(); ++k) {
        const double x = below_ ? left + 12.0 + column_ * static_cast<double>(k / rows_) : right + 26.0;
        const double y = below_ ? end + 10.0 + 20.0 * static_cast<double>(k % rows_) : top + 10.0 + 20.0 * static_cast<double>(k);
        made += fmt::format("<g transform=\"translate({} {})\">{}{}</g>\n", px(x), px(y), entries_[k].drawing,
                            fmt::format("<text x=\"18\" y=\"4\" class=\"legend\">{}</text>", escaped(entries_[k].name)));
    }
    return made;
}

std::string palette(std::size_t number) {
    static constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#444444", "#8c6d1f"};
    return colours[number % colours.size()];
}

Line palette_line(std::size_t number) {
    static constexpr std::array lines{Line::solid, Line::dashed, Line::dotted};
    return lines[number / 8 % lines.size()];
}

}  // namespace cvtflow::tools
