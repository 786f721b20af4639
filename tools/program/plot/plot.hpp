#pragma once
/// A picture of numbers as data: series, a region, two axes. Drawn as SVG by svg(), without any library.

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// How an axis places its values.
enum class Scale {
    linear,
    logarithmic,  ///< decades; values ≤ 0 are left out
    symlog,       ///< linear up to `Axis::linear_up_to`, decades beyond it on either side
};

struct Axis {
    std::string label;  ///< with its unit: "step [s]"
    Scale scale = Scale::linear;
    double linear_up_to = 1.0;           ///< symlog only: > 0
    std::optional<double> from{}, to{};  ///< ends; absent: those of the points, with a margin
};

enum class Mark { none, dot, small_dot, ring, square, diamond, triangle, cross };
enum class Line { none, solid, dashed, dotted };

struct Point {
    double x, y;
};

struct Series {
    std::string name;           ///< in the legend; empty: not in the legend
    std::vector<Point> points;  ///< in the order in which a line joins them; points that are not finite interrupt it
    Mark mark = Mark::dot;
    Line line = Line::none;
    std::string colour;     ///< as in CSS; empty: the next of the palette
    double width = 1.6;     ///< of the line [px]; a broad one, drawn first, shows below others that agree with it
    bool sets_ends = true;  ///< whether the axes reach its points; else it is cut where they end
};

/// A shaded part of the plane: where `inside` holds.
struct Region {
    std::string name;
    std::function<bool(double x, double y)> inside;
    std::string colour = "#dbe7f3";
};

/// Values over a grid, between whose points they are interpolated: colours, and contours at round values.
struct Field {
    std::string label;           ///< of the values, with their unit: "slip [%]"
    std::vector<double> x, y;    ///< ascending, two at least
    std::vector<double> values;  ///< [y][x]; cells with a corner that is not finite stay empty
};

/// A horizontal bar, with its name before it and a text behind it.
struct Bar {
    std::string name;
    double value;      ///< in the unit of Plot::y
    std::string text;  ///< "123 W (45 %)"
};

struct Plot {
    std::string title;
    std::string subtitle;  ///< conditions, in smaller letters; may be empty
    Axis x, y;
    std::vector<Series> series{};
    std::vector<Region> regions{};             ///< below the series, in this order
    std::vector<Field> fields{};               ///< above the regions, below the series
    std::vector<Bar> bars{};                   ///< if there are any, they are the picture, from top to bottom
    double width = 860.0, height = 540.0;      ///< of the picture [px], without a legend below it
    double left_room = 0.0, right_room = 0.0;  ///< beside the frame, at least: aligns pictures below one another [px]
};

/// The plot as an SVG document: white background, grid, ticks with round numbers. The legend is at the right; below the picture, which
/// becomes higher by it, where it would take more than a third of the width.
/// @throws std::invalid_argument if an axis has no length, or a symlog axis no linear part
[[nodiscard]] std::string svg(const Plot& plot);

/// Pictures below one another as one SVG document; those with the same horizontal axis have it at the same place.
[[nodiscard]] std::string svg(const std::vector<Plot>& plots);

/// The colour that the series of that number gets if it names none: eight, distinguishable by colour-blind readers. Where colours repeat,
/// lines differ: solid, dashed, dotted.
[[nodiscard]] std::string palette(std::size_t number);
[[nodiscard]] Line palette_line(std::size_t number);

}  // namespace cvtflow::tools
