#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "engine/base/hash.hpp"
#include "tools/program/plot/axis_scale.hpp"
#include "tools/program/plot/field.hpp"
#include "tools/program/plot/plot.hpp"
#include "tools/program/text/markup.hpp"

namespace cvtflow::tools {

namespace {

constexpr double letter = 6.9;  ///< mean width of a character at 12 px, to leave room [px]

/// A text, escaped for the picture.
std::string escaped(std::string text) {
    std::erase_if(text, [](char c) { return static_cast<unsigned char>(c) < 0x20; });  // XML knows no control characters
    return html(text);
}

/// Characters of a text in UTF-8.
double letters(const std::string& text) {
    return static_cast<double>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// A tenth of a pixel is enough.
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

/// The series with the colour and the line that its number gives it, where it has none of its own.
Series styled(const Series& series, std::size_t number) {
    Series with = series;
    if (!with.colour.empty()) return with;
    with.colour = palette(number);
    if (with.line == Line::solid) with.line = palette_line(number);
    return with;
}

/// Series, regions and fields that have names. `drawing` is around the origin, 24 px wide.
struct LegendEntry {
    std::string name, drawing;
    double height = 20.0;            ///< [px]
    double longest = letters(name);  ///< text beside the drawing [letters]
};
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
        const ColourBar bar = colour_bar(field);
        double longest = 0.0;
        for (const std::string& label : bar.labels) longest = std::max(longest, letters(label));
        entries.push_back({field.label, ""});
        entries.push_back({"", bar.svg, bar.height + 20.0, longest});
    }
    return entries;
}

/// Where the entries are: in one column at the right of the frame, or in columns below it.
class Legend {
public:
    explicit Legend(const Plot& plot) : entries_(legend_of(plot)) {
        if (entries_.empty()) return;
        double names = 0.0;
        for (const LegendEntry& entry : entries_) names = std::max(names, entry.longest);
        width_ = 56.0 + letter * names;
        below_ = width_ > plot.width / 3.0 && plot.fields.empty();
        column_ = 44.0 + letter * names;
        columns_ = std::max<std::size_t>(1, static_cast<std::size_t>((plot.width - 40.0) / column_));
        rows_ = (entries_.size() + columns_ - 1) / columns_;
    }
    [[nodiscard]] double width() const noexcept { return below_ ? 20.0 : width_; }                                   ///< at the right [px]
    [[nodiscard]] double height() const noexcept { return below_ ? 20.0 * static_cast<double>(rows_) + 8.0 : 0.0; }  ///< below [px]
    /// @param left, right, top of the frame   @param end of the picture without the legend [px]
    [[nodiscard]] std::string text(double left, double right, double top, double end) const {
        std::string made;
        double beside = top + 10.0;
        for (std::size_t k = 0; k < entries_.size(); ++k) {
            const double x = below_ ? left + 12.0 + column_ * static_cast<double>(k / rows_) : right + 26.0;
            const double y = below_ ? end + 10.0 + 20.0 * static_cast<double>(k % rows_) : beside;
            beside += entries_[k].height;
            made += fmt::format("<g transform=\"translate({} {})\">{}{}</g>\n", px(x), px(y), entries_[k].drawing,
                                fmt::format("<text x=\"18\" y=\"4\" class=\"legend\">{}</text>", escaped(entries_[k].name)));
        }
        return made;
    }

private:
    std::vector<LegendEntry> entries_;
    bool below_ = false;
    std::size_t rows_ = 0, columns_ = 1;
    double width_ = 20.0, column_ = 0.0;
};

/// Size of a picture: its height with the legend, and the width beside its frame [px].
struct PictureSize {
    double height = 0.0, left = 0.0, right = 0.0;
};

/// Beginning of a document: its title, and white paper.
std::string opening(double width, double height, const std::string& title) {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
        "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#222\">\n<title>{2}</title>\n"
        "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n",
        px(width), px(height), escaped(title));
}

std::string text_at(double x, double y, const std::string& text, const std::string& more) {
    return fmt::format("<text x=\"{}\" y=\"{}\" {}>{}</text>\n", px(x), px(y), more, escaped(text));
}

constexpr double subtitle_line = 18.0;  // [px]

/// A text broken at spaces into lines of no more letters than that; no line of an empty text.
std::vector<std::string> wrapped(const std::string& text, double longest) {
    std::vector<std::string> lines;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find(' ', begin), text.size());
        const std::string word = text.substr(begin, end - begin);
        if (!lines.empty() && letters(lines.back() + " " + word) <= longest)
            lines.back() += " " + word;
        else
            lines.push_back(word);
        begin = end + 1;
    }
    return lines;
}

std::vector<double> all(const Plot& plot, double Point::*coordinate) {
    std::vector<double> values;
    for (const Series& series : plot.series) {
        if (!series.sets_ends) continue;
        for (const Point& point : series.points) values.push_back(point.*coordinate);
    }
    const auto of_field = coordinate == &Point::x ? &Field::x : &Field::y;
    for (const Field& field : plot.fields) values.insert(values.end(), (field.*of_field).begin(), (field.*of_field).end());
    return values;
}

class Drawing {
public:
    explicit Drawing(const Plot& plot) : plot_(plot), x_(plot.x, all(plot, &Point::x)), y_(plot.y, all(plot, &Point::y)), legend_(plot) {
        y_ticks_ = y_.ticks(static_cast<int>(plot.height / 60.0));
        double widest = 0.0;
        for (const Tick& tick : y_ticks_) widest = std::max(widest, letters(tick.label));
        left_ = std::max(plot.left_room, 44.0 + letter * widest);
        subtitle_ = wrapped(plot.subtitle, (plot.width - left_ - 8.0) / letter);
        top_ = 44.0 + subtitle_line * static_cast<double>(subtitle_.size());
        right_ = plot.width - std::max(plot.right_room, legend_.width());
        bottom_ = std::max(plot.height - 52.0, top_ + 80.0);
        x_ticks_ = x_.ticks(std::max(3, static_cast<int>((right_ - left_) / 90.0)));
    }

    [[nodiscard]] PictureSize size() const { return {plot_.height + legend_.height(), left_, plot_.width - right_}; }

    [[nodiscard]] std::string text() const {
        std::string made = opening(plot_.width, size().height, plot_.title);
        made += fmt::format("<clipPath id=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>\n", name(), px(left_),
                            px(top_), px(right_ - left_), px(bottom_ - top_));
        const std::string clipped = fmt::format("<g clip-path=\"url(#{})\">\n", name());
        const auto x_of = [this](double value) { return at_x(value); };
        const auto y_of = [this](double value) { return at_y(value); };
        made += clipped;
        for (const Region& region : plot_.regions) made += shade(region);
        made += grid();
        for (const Field& field : plot_.fields) made += field_svg(field, x_of, y_of);
        made += "</g>\n" + frame() + clipped;
        for (std::size_t k = 0; k < plot_.series.size(); ++k) made += draw(styled(plot_.series[k], k));
        return made + "</g>\n" + headings() + legend_.text(left_, right_, top_, plot_.height) + "</svg>\n";
    }

private:
    /// Name of the frame: a document may contain several pictures.
    [[nodiscard]] std::string name() const {
        engine::Hash hash;
        for (const std::string& part : {plot_.title, plot_.subtitle, plot_.x.label, plot_.y.label}) hash.add(std::string_view(part));
        return "frame" + hash.hex();
    }
    [[nodiscard]] double at_x(double value) const { return left_ + x_.place(value) * (right_ - left_); }
    [[nodiscard]] double at_y(double value) const { return bottom_ - y_.place(value) * (bottom_ - top_); }
    [[nodiscard]] std::string grid() const {
        std::string strong, faint;
        for (const Tick& tick : x_ticks_)
            (tick.label.empty() ? faint : strong) += fmt::format("M{} {}V{}", px(at_x(tick.value)), px(top_), px(bottom_));
        for (const Tick& tick : y_ticks_)
            (tick.label.empty() ? faint : strong) += fmt::format("M{} {}H{}", px(left_), px(at_y(tick.value)), px(right_));
        return fmt::format(
            "<path d=\"{}\" stroke=\"#000\" stroke-opacity=\"0.05\" fill=\"none\"/>\n<path d=\"{}\" stroke=\"#000\" "
            "stroke-opacity=\"0.14\" fill=\"none\"/>\n",
            faint, strong);
    }

    [[nodiscard]] std::string frame() const {
        std::string made = fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#666\"/>\n", px(left_),
                                       px(top_), px(right_ - left_), px(bottom_ - top_));
        double free_from = -INFINITY;
        for (const Tick& tick : x_ticks_) {
            const double half = 0.5 * letter * letters(tick.label);
            if (tick.label.empty() || at_x(tick.value) - half < free_from) continue;  // labels do not touch
            made += text_at(at_x(tick.value), bottom_ + 17.0, tick.label, "text-anchor=\"middle\" class=\"x\"");
            free_from = at_x(tick.value) + half + 4.0;
        }
        double free_below = INFINITY;
        for (const Tick& tick : y_ticks_) {
            if (tick.label.empty() || at_y(tick.value) + 6.0 > free_below) continue;
            made += text_at(left_ - 6.0, at_y(tick.value) + 4.0, tick.label, "text-anchor=\"end\" class=\"y\"");
            free_below = at_y(tick.value) - 6.0;
        }
        return made;
    }

    [[nodiscard]] std::string headings() const {
        std::string made = text_at(left_, 24.0, plot_.title, "font-size=\"16\" font-weight=\"bold\"");
        for (std::size_t k = 0; k < subtitle_.size(); ++k)
            made += text_at(left_, 44.0 + subtitle_line * static_cast<double>(k), subtitle_[k], "fill=\"#555\"");
        made += text_at(0.5 * (left_ + right_), bottom_ + 40.0, plot_.x.label, "text-anchor=\"middle\" font-size=\"13\"");
        const double middle = 0.5 * (top_ + bottom_);
        return made + text_at(16.0, middle, plot_.y.label,
                              fmt::format("text-anchor=\"middle\" font-size=\"13\" transform=\"rotate(-90 16 {})\"", px(middle)));
    }

    [[nodiscard]] std::string draw(const Series& series) const {
        const std::string colour = escaped(series.colour);
        std::string line, marks;
        bool joined = false;
        for (const Point& point : series.points) {
            if (!x_.shows(point.x) || !y_.shows(point.y)) {
                joined = false;
                continue;
            }
            // Far outside is as good as just outside, and fits into the numbers that drawing programs take.
            const double x = std::clamp(at_x(point.x), -1e4, 1e4), y = std::clamp(at_y(point.y), -1e4, 1e4);
            line += fmt::format("{}{} {}", joined ? "L" : "M", px(x), px(y));
            marks += mark_path(series.mark, x, y);
            joined = true;
        }
        std::string made;
        if (series.line != Line::none && !line.empty()) made += fmt::format("<path d=\"{}\" {}/>\n", line, line_style(series, colour));
        if (!marks.empty()) made += fmt::format("<path d=\"{}\" {}/>\n", marks, mark_style(series.mark, colour));
        return made;
    }

    /// Rows of 1.5 px; the ends of each run within a row are bisected.
    [[nodiscard]] std::string shade(const Region& region) const {
        constexpr double row = 1.5, column = 2.0;
        std::string path;
        for (double y = top_; y < bottom_; y += row) {
            const double value = y_.value((bottom_ - y - 0.5 * row) / (bottom_ - top_));
            const auto inside = [&](double x) { return region.inside(x_.value((x - left_) / (right_ - left_)), value); };
            bool was = inside(left_);
            double begin = left_, before = left_;
            while (before < right_) {
                const double x = std::min(before + column, right_);
                const bool is = inside(x);
                if (is != was) {
                    const double edge = bisect(before, x, was, inside);
                    if (was) path += run(begin, edge, y, row);
                    begin = edge, was = is;
                }
                before = x;
            }
            if (was) path += run(begin, right_, y, row);
        }
        return fmt::format("<path class=\"region\" d=\"{}\" fill=\"{}\"/>\n", path, escaped(region.colour));
    }

    template <class Inside>
    static double bisect(double from, double to, bool was, const Inside& inside) {
        for (int halving = 0; halving < 5; ++halving) {
            const double middle = 0.5 * (from + to);
            (inside(middle) == was ? from : to) = middle;
        }
        return 0.5 * (from + to);
    }

    static std::string run(double from, double to, double y, double height) {
        return fmt::format("M{} {}H{}V{}H{}z", px(from), px(y), px(to), px(y + height + 0.1), px(from));
    }

    const Plot& plot_;
    const AxisScale x_, y_;
    const Legend legend_;
    std::vector<Tick> x_ticks_, y_ticks_;
    std::vector<std::string> subtitle_;
    double left_ = 0.0, right_ = 0.0, top_ = 0.0, bottom_ = 0.0;  ///< of the frame [px]
};

constexpr double bar_row = 24.0, above_bars = 62.0;  // [px]

double height_of_bars(const Plot& plot) { return above_bars + bar_row * static_cast<double>(plot.bars.size()) + 16.0; }

std::string bars_svg(const Plot& plot) {
    double names = 0.0, texts = 0.0, largest = 1e-300;
    for (const Bar& bar : plot.bars) {
        names = std::max(names, letters(bar.name)), texts = std::max(texts, letters(bar.text));
        largest = std::max(largest, std::abs(bar.value));
    }
    const double left = 24.0 + letter * names, longest = std::max(40.0, plot.width - left - 24.0 - letter * texts);
    std::string made = opening(plot.width, height_of_bars(plot), plot.title);
    made += text_at(16.0, 24.0, plot.title, "font-size=\"16\" font-weight=\"bold\"") + text_at(16.0, 44.0, plot.subtitle, "fill=\"#555\"");
    double y = above_bars;
    for (const Bar& bar : plot.bars) {
        const double length = longest * std::abs(bar.value) / largest;
        made += text_at(left - 8.0, y + 15.0, bar.name, "text-anchor=\"end\"") +
                fmt::format("<rect class=\"bar\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"16\" fill=\"{}\"/>\n", px(left), px(y + 3.0),
                            px(length), bar.value < 0.0 ? palette(1) : palette(0)) +
                text_at(left + length + 6.0, y + 15.0, bar.text, "class=\"value\"");
        y += bar_row;
    }
    return made + "</svg>\n";
}

PictureSize size_of(const Plot& plot) { return plot.bars.empty() ? Drawing(plot).size() : PictureSize{height_of_bars(plot), 0.0, 0.0}; }

}  // namespace

std::string palette(std::size_t number) {
    static constexpr std::array colours{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#444444", "#8c6d1f"};
    return colours[number % colours.size()];
}

Line palette_line(std::size_t number) {
    static constexpr std::array lines{Line::solid, Line::dashed, Line::dotted};
    return lines[number / 8 % lines.size()];
}

std::string svg(const Plot& plot) { return plot.bars.empty() ? Drawing(plot).text() : bars_svg(plot); }

std::string svg(const std::vector<Plot>& plots) {
    if (plots.size() == 1) return svg(plots.front());
    std::map<std::pair<std::string, double>, PictureSize> rooms;  // largest of plots that share a horizontal axis and a width
    for (const Plot& plot : plots) {
        const PictureSize size = size_of(plot);
        PictureSize& room = rooms[{plot.x.label, plot.width}];
        room = {0.0, std::max(room.left, size.left), std::max(room.right, size.right)};
    }
    double width = 0.0, height = 0.0;
    std::string parts;
    for (const Plot& plot : plots) {
        Plot aligned = plot;
        const PictureSize& room = rooms.at({plot.x.label, plot.width});
        aligned.left_room = room.left, aligned.right_room = room.right;  // as large as its own at least
        std::string part = svg(aligned);
        part.insert(part.find("<svg") + 4, fmt::format(" y=\"{:g}\"", height));
        parts += part;
        width = std::max(width, plot.width);
        height += size_of(aligned).height;
    }
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:g}\" height=\"{1:g}\" viewBox=\"0 0 {0:g} {1:g}\" role=\"img\">\n"
        "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#ffffff\"/>\n{2}</svg>\n",
        width, height, parts);
}

}  // namespace cvtflow::tools
