#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "engine/base/hash.hpp"
#include "tools/program/plot/axis_scale.hpp"
#include "tools/program/plot/field.hpp"
#include "tools/program/plot/plot.hpp"
#include "tools/program/plot/svg_parts.hpp"

namespace cvtflow::tools {

namespace {

std::string text_at(double x, double y, const std::string& text, const std::string& more) {
    return fmt::format("<text x=\"{}\" y=\"{}\" {}>{}</text>\n", px(x), px(y), more, escaped(text));
}

std::vector<double> all(const Plot& plot, double Point::*coordinate) {
    std::vector<double> values;
    for (const Series& series : plot.series) {
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
        top_ = plot.subtitle.empty() ? 44.0 : 62.0;
        right_ = plot.width - std::max(plot.right_room, legend_.width());
        bottom_ = std::max(plot.height - 52.0, top_ + 80.0);
        x_ticks_ = x_.ticks(std::max(3, static_cast<int>((right_ - left_) / 90.0)));
    }

    [[nodiscard]] PictureSize size() const { return {plot_.height + legend_.height(), left_, plot_.width - right_}; }

    [[nodiscard]] std::string text() const {
        std::string made = fmt::format(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
            "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#222\">\n<title>{2}</title>\n"
            "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n"
            "<clipPath id=\"{7}\"><rect x=\"{3}\" y=\"{4}\" width=\"{5}\" height=\"{6}\"/></clipPath>\n",
            px(plot_.width), px(size().height), escaped(plot_.title), px(left_), px(top_), px(right_ - left_), px(bottom_ - top_), name());
        const std::string clipped = fmt::format("<g clip-path=\"url(#{})\">\n", name());
        const auto x_of = [this](double value) { return at_x(value); };
        const auto y_of = [this](double value) { return at_y(value); };
        made += clipped;
        for (const Region& region : plot_.regions) made += shade(region);
        for (const Field& field : plot_.fields) made += field_svg(field, x_of, y_of);
        made += grid() + "</g>\n" + frame() + clipped;
        for (std::size_t k = 0; k < plot_.series.size(); ++k) made += draw(styled(plot_.series[k], k));
        return made + "</g>\n" + headings() + legend_.text(left_, right_, top_, plot_.height) + "</svg>\n";
    }

private:
    /// Of the frame: one document may hold several pictures.
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
        if (!plot_.subtitle.empty()) made += text_at(left_, 44.0, plot_.subtitle, "fill=\"#555\"");
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
    double left_ = 0.0, right_ = 0.0, top_ = 0.0, bottom_ = 0.0;  ///< of the frame [px]
};

}  // namespace

std::string svg(const Plot& plot) { return Drawing(plot).text(); }

PictureSize picture_size(const Plot& plot) { return Drawing(plot).size(); }

}  // namespace cvtflow::tools
