#pragma once
/// A picture of numbers as data: series, a region, two axes. The Python package draws it (tools/program/drawing.hpp).

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cvtflow::tools {

/// Spacing of values along an axis.
enum class Scale {
    linear,
    logarithmic,  ///< decades; values ≤ 0 are left out
    symlog,       ///< linear up to `Axis::linear_up_to`, decades beyond it on either side
};

struct Axis {
    std::string label;  ///< name and unit: "step [s]"
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
    std::string name;           ///< entry of the legend; empty: none
    std::vector<Point> points;  ///< points in the order of the line; points that are not finite interrupt it
    Mark mark = Mark::dot;
    Line line = Line::none;
    std::string colour;  ///< CSS colour; empty: the next of the palette
    double width = 1.6;  ///< width of the line [px]; a broad one, drawn first, shows below others that agree with it
};

/// A shaded part of the plane: where `inside` holds.
struct Region {
    std::string name;
    std::function<bool(double x, double y)> inside;
    std::string colour = "#dbe7f3";
};

struct Plot {
    std::string title;
    std::string subtitle;  ///< conditions, in smaller letters; may be empty
    Axis x, y;
    std::vector<Series> series{};
    std::vector<Region> regions{};  ///< drawn below the series, in this order
};

/// The plot as an SVG document, the same every time.
/// @throws std::runtime_error see drawn()
[[nodiscard]] std::string svg(const Plot& plot);
/// Pictures below one another as one SVG document; those with the same horizontal axis have it at the same place.
[[nodiscard]] std::string svg(const std::vector<Plot>& plots);

/// The colour that the series of that number gets if it names none: eight, distinguishable by colour-blind readers.
[[nodiscard]] std::string palette(std::size_t number);

}  // namespace cvtflow::tools
